#include "frontend/odometry/preprocessing.hpp"

#include <algorithm>
#include <vector>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kBlock = 8192;

// The sensor's pose over the sweep, at equal steps in time; poses in between are interpolated
// linearly, which at 64 steps departs from the exponential by less than a micrometre at any speed
// of a vehicle.
class SweepSteps {
 public:
  SweepSteps(const SensorMotion& motion, double reference_time, float first, float last)
      : first_(first),
        scale_(last - first > kShortest ? static_cast<float>(kSteps) / (last - first) : 0.0F) {
    steps_.reserve(kSteps + 2);
    for (std::size_t i = 0; i <= kSteps + 1; ++i) {
      const double t = first + (last - first) * static_cast<double>(i) / kSteps;
      steps_.emplace_back(motion.after(t - reference_time));
    }
  }

  [[nodiscard]] Eigen::Vector3f move(const Eigen::Vector3f& p, float time) const {
    const float s = (time - first_) * scale_;
    const auto i = std::min(static_cast<std::size_t>(std::max(s, 0.0F)), kSteps);
    const float f = s - static_cast<float>(i);
    return (1.0F - f) * (steps_[i] * p) + f * (steps_[i + 1] * p);
  }

 private:
  static constexpr std::size_t kSteps = 64;
  // Within less no sensor moves; and what divides by much less is no number.
  static constexpr float kShortest = 1e-6F;  // s
  float first_;
  float scale_;
  std::vector<PoseF> steps_;
};

class RangeGate {
 public:
  RangeGate(double min_range, double max_range)
      : lower_(static_cast<float>(min_range * min_range)),
        upper_(static_cast<float>(max_range * max_range)) {}
  // False for NaN.
  [[nodiscard]] bool operator()(const Eigen::Vector3f& p) const {
    const float squared_range = p.squaredNorm();
    return squared_range > lower_ && squared_range <= upper_;
  }

 private:
  float lower_, upper_;  // m^2
};

}  // namespace

Points deskew_and_crop(const Scan& scan, const SensorMotion& motion, double reference_time,
                       double min_range, double max_range) {
  const RangeGate in_range(min_range, max_range);
  const bool moves = !scan.times.empty() && scan.times.size() == scan.points.size();
  float first = 0.0F, last = 0.0F;
  if (moves) {
    const auto [min, max] = std::minmax_element(scan.times.begin(), scan.times.end());
    first = *min;
    last = *max;
  }
  const SweepSteps steps(motion, reference_time, first, last);
  std::vector<Points> parts((scan.points.size() + kBlock - 1) / kBlock);
  for_each_block(scan.points.size(), kBlock,
                 [&](std::size_t block, std::size_t begin, std::size_t end) {
                   Points& part = parts[block];
                   part.reserve(end - begin);
                   for (std::size_t i = begin; i < end; ++i) {
                     const Eigen::Vector3f& p = scan.points[i];
                     if (in_range(p)) part.push_back(moves ? steps.move(p, scan.times[i]) : p);
                   }
                 });
  if (parts.size() == 1) return std::move(parts.front());
  Points points;
  points.reserve(scan.points.size());
  for (const Points& part : parts) points.insert(points.end(), part.begin(), part.end());
  return points;
}

std::vector<float> values_within(const Scan& scan, const std::vector<float>& values,
                                 double min_range, double max_range) {
  const RangeGate in_range(min_range, max_range);
  std::vector<float> kept;
  kept.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (in_range(scan.points[i])) kept.push_back(values[i]);
  }
  return kept;
}

std::vector<float> times_within(const Scan& scan, double min_range, double max_range) {
  return values_within(scan, scan.times, min_range, max_range);
}

Points VoxelDownsampler::operator()(const Points& points, float voxel_size) {
  table_.clear();
  const float inverse = 1.0F / voxel_size;
  Points kept;
  kept.reserve(points.size() / 4);
  for (const Eigen::Vector3f& p : points) {
    const auto index = static_cast<std::uint32_t>(kept.size());
    if (table_.find_or_insert(voxel_key(voxel_of(p, inverse)), index) == index) kept.push_back(p);
  }
  return kept;
}

Points VoxelDownsampler::operator()(const Points& points, float voxel_size,
                                    std::vector<float>& values) {
  Points kept = (*this)(points, voxel_size);
  // The points kept are in order: each is the next that equals it.
  std::size_t i = 0;
  for (std::size_t k = 0; k < kept.size(); ++k, ++i) {
    while (points[i] != kept[k]) ++i;
    values[k] = values[i];
  }
  values.resize(kept.size());
  return kept;
}

}  // namespace groundloop
