// From a raw scan to what odometry and local maps use: range limits, deskewing with a constant
// velocity, and voxel downsampling that keeps the first point of each voxel (KISS-ICP, Sec. III-A
// and III-B).
#pragma once

#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {

/// Points of `scan` with ranges in [min_range, max_range] metres, moved to where they would have
/// been measured from at `reference_time` (seconds from the stamp) had the sensor kept the velocity
/// `twist` (m/s, rad/s; sensor frame). Scans without times are only cropped. Order is kept.
[[nodiscard]] Points deskew_and_crop(const Scan& scan, const Vector6d& twist, double reference_time,
                                     double min_range, double max_range);

/// Keeps the first point of each voxel, in order. One object reuses its table from scan to scan.
class VoxelDownsampler {
 public:
  [[nodiscard]] Points operator()(const Points& points, float voxel_size);

 private:
  VoxelTable table_{1 << 16};
};

}  // namespace groundloop
