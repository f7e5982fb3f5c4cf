// What a report shows of a session's map: a cloud in levels of detail for the 3-D view, pictures
// from above, in the solution and by odometry, and how thick surfaces are. Local maps are read one
// at a time, twice; memory is that of what is shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "apps/report/point_octree.hpp"
#include "apps/report/scan_table.hpp"
#include "apps/report/session_contents.hpp"
#include "apps/report/top_view.hpp"

namespace groundloop::apps {

/// Of one frame.
struct FrameView {
  TopWindow window;
  GreyPicture optimised, odometry;  ///< from above
  PointOctree octree;               ///< in the solution; rows are those of the scan table
  /// Of the surface about each point of the octree: standard deviation of the points within 1 m
  /// across their best plane, m; negative where they are no surface.
  std::vector<float> thickness;
};

/// One a frame. `most_points` are shared between frames by the number of their scans; with 0 there
/// are only pictures.
[[nodiscard]] std::vector<FrameView> make_map_views(const SessionContents& contents,
                                                    const ScanTable& table,
                                                    std::size_t most_points);

}  // namespace groundloop::apps
