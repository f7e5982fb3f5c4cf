// One scan as small pictures: from above, as a range image, and when its points were measured. The
// terminal's sketch and the PNG are both drawn from these.
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/core/scan.hpp"

namespace groundloop::apps {

/// Values row by row from the top; NaN where there is nothing.
struct Raster {
  std::size_t width = 0, height = 0;
  std::vector<float> values;
  [[nodiscard]] float at(std::size_t column, std::size_t row) const {
    return values[row * width + column];
  }
};

/// The scan from above, x (forward) up and y to the left, the sensor in the middle: the highest z
/// (m) in each cell. `half_m`: from the middle to every edge.
[[nodiscard]] Raster seen_from_above(const Scan& scan, std::size_t width, std::size_t height,
                                     double half_m);
/// Of a scan's points nine tenths lie within so much (m, horizontally), rounded up to 5 m.
[[nodiscard]] double usual_reach(const Scan& scan);

/// What a range image shows.
struct View {
  double left_deg = 180.0, right_deg = -180.0;  ///< azimuth, counted to the left from x
  double top_deg = 0.0, bottom_deg = 0.0;       ///< elevation
};
/// The sector and the elevations that hold points.
[[nodiscard]] View view_of(const Scan& scan);
/// The nearest range (m) in each cell, azimuth from left to right as one looks forward.
[[nodiscard]] Raster range_image(const Scan& scan, std::size_t width, std::size_t height,
                                 const View& view);

/// Median time (s) of the points in each of `width` parts of the scan, in the order in which the
/// recording holds them; empty where points have no times.
[[nodiscard]] std::vector<double> times_along(const Scan& scan, std::size_t width);

}  // namespace groundloop::apps
