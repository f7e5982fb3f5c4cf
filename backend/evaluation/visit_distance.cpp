#include "backend/evaluation/visit_distance.hpp"

#include <algorithm>
#include <vector>

#include "frontend/core/voxel_table.hpp"

namespace groundloop {
namespace {

struct Stop {
  Pose estimate, truth;
  double way = 0.0;      // m
  double seconds = 0.0;  // from the first
};

// Every metre of the way, so that slow stretches do not count more.
std::vector<Stop> stops_of(const Trajectory& estimate, const Trajectory& truth,
                           std::span<const std::pair<std::size_t, std::size_t>> pairs,
                           double spacing) {
  std::vector<Stop> stops;
  double way = 0.0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const StampedPose &e = estimate[pairs[k].first], &t = truth[pairs[k].second];
    if (k > 0) way += (t.pose.translation - truth[pairs[k - 1].second].pose.translation).norm();
    if (!stops.empty() && way < stops.back().way + spacing) continue;
    const Nanoseconds first = truth[pairs.front().second].stamp;
    stops.push_back({e.pose, t.pose, way, static_cast<double>(t.stamp - first) * 1e-9});
  }
  return stops;
}

// Stops in cells as wide as two may be apart.
class StopIndex {
 public:
  StopIndex(const std::vector<Stop>& stops, double cell)
      : stops_(stops), inverse_(static_cast<float>(1.0 / cell)) {
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const auto next = static_cast<std::uint32_t>(cells_.size());
      const std::uint32_t cell_number = table_.find_or_insert(voxel_key(voxel(i)), next);
      if (cell_number == next) cells_.emplace_back();
      cells_[cell_number].push_back(i);
    }
  }

  // Calls f(j) for the stops after i that are in the cells about it.
  template <typename F>
  void for_each_near(std::size_t i, F&& f) const {
    const Eigen::Vector3i centre = voxel(i);
    for (int n = 0; n < 27; ++n) {
      const Eigen::Vector3i offset(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      const std::uint32_t cell = table_.find(voxel_key(centre + offset));
      if (cell == VoxelTable::kNone) continue;
      for (const std::size_t j : cells_[cell]) {
        if (j > i) f(j);
      }
    }
  }

 private:
  [[nodiscard]] Eigen::Vector3i voxel(std::size_t i) const {
    const Eigen::Vector3d from_start =
        stops_[i].truth.translation - stops_.front().truth.translation;
    return voxel_of(from_start.cast<float>(), inverse_);
  }

  const std::vector<Stop>& stops_;
  float inverse_;
  VoxelTable table_;
  std::vector<std::vector<std::size_t>> cells_;
};

VisitDistance summary(std::vector<double> distances) {
  VisitDistance result;
  result.pairs = distances.size();
  if (distances.empty()) return result;
  std::sort(distances.begin(), distances.end());
  result.median_m = distances[distances.size() / 2];
  result.most_m = distances[std::min(distances.size() - 1, distances.size() * 95 / 100)];
  return result;
}

}  // namespace

VisitDistances visit_distances(const Trajectory& estimate, const Trajectory& truth,
                               std::span<const std::pair<std::size_t, std::size_t>> pairs,
                               const VisitDistanceOptions& options) {
  const std::vector<Stop> stops = stops_of(estimate, truth, pairs, options.spacing);
  if (stops.empty()) return {};
  const StopIndex index(stops, options.within);
  std::vector<double> by_way, by_time;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const Stop& a = stops[i];
    index.for_each_near(i, [&](std::size_t j) {
      const Stop& b = stops[j];
      if ((a.truth.translation - b.truth.translation).norm() > options.within) return;
      const double way = b.way - a.way;
      const bool far = way > options.way;
      const bool later = way > options.least_way && b.seconds - a.seconds > options.seconds;
      if (!far && !later) return;
      const Pose by_estimate = a.estimate.inverse() * b.estimate;
      const Pose by_truth = a.truth.inverse() * b.truth;
      const double distance = (by_estimate.inverse() * by_truth).translation.norm();
      if (far) by_way.push_back(distance);
      if (later) by_time.push_back(distance);
    });
  }
  return {summary(std::move(by_way)), summary(std::move(by_time))};
}

}  // namespace groundloop
