// From a raw scan to what odometry and local maps use: range limits, deskewing with a velocity
// that is constant or changes evenly, and voxel downsampling that keeps the first point of each
// voxel (KISS-ICP, Sec. III-A and III-B).
#pragma once

#include <vector>

#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {

/// How a sensor moves about an instant, in its own frame then.
struct SensorMotion {
  Vector6d velocity = Vector6d::Zero();  ///< m/s, rad/s
  Vector6d change = Vector6d::Zero();    ///< of the velocity, a second
  /// The sensor's pose `seconds` after the instant, in its frame at the instant.
  [[nodiscard]] Pose after(double seconds) const {
    return exp_se3(seconds * velocity + 0.5 * seconds * seconds * change);
  }
};

/// Points of `scan` with ranges in [min_range, max_range] metres, moved to where they would have
/// been measured from at `reference_time` (seconds from the stamp) had the sensor moved by `motion`
/// about that time. Scans without times are only cropped. Order is kept.
[[nodiscard]] Points deskew_and_crop(const Scan& scan, const SensorMotion& motion,
                                     double reference_time, double min_range, double max_range);

/// Of `values`, one a point of `scan` or none, those of the points that deskew_and_crop keeps, in
/// their order.
[[nodiscard]] std::vector<float> values_within(const Scan& scan, const std::vector<float>& values,
                                               double min_range, double max_range);
/// The same of the points' times, s from the stamp.
[[nodiscard]] std::vector<float> times_within(const Scan& scan, double min_range, double max_range);

/// Keeps the first point of each voxel, in order. One object reuses its table from scan to scan.
class VoxelDownsampler {
 public:
  [[nodiscard]] Points operator()(const Points& points, float voxel_size);
  /// As above, and leaves of `values`, one a point, those of the points kept.
  [[nodiscard]] Points operator()(const Points& points, float voxel_size,
                                  std::vector<float>& values);

 private:
  VoxelTable table_{1 << 16};
};

}  // namespace groundloop
