// How far apart a solution puts two visits of a place: for pairs of scans that truly stood within a
// few metres of each other at different times, the norm of the translation of T_estimate^-1
// T_truth, T being the pose of the one in the other. No alignment enters, and no drift between
// places: it is what a map of double walls is thick by.
#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "frontend/core/trajectory.hpp"

namespace groundloop {

struct VisitDistanceOptions {
  double within = 5.0;    ///< m, between the true positions
  double way = 100.0;     ///< m, between the two along the true trajectory, or
  double seconds = 30.0;  ///< between the two, and
  double least_way = 20;  ///< m, along the true trajectory: who stands still visits nothing twice
  double spacing = 1.0;   ///< m, along the true trajectory, between scans that are looked at
};

struct VisitDistance {
  std::size_t pairs = 0;
  double median_m = 0.0, most_m = 0.0;  ///< most: 95 % of the pairs stay below
};

struct VisitDistances {
  VisitDistance by_way;   ///< more than `way` apart
  VisitDistance by_time;  ///< more than `seconds` and `least_way` apart
};

/// `pairs`: places in both trajectories of poses of the same instants, in time order, as
/// evaluate_trajectory finds them. Poses of both are of the sensor.
[[nodiscard]] VisitDistances visit_distances(
    const Trajectory& estimate, const Trajectory& truth,
    std::span<const std::pair<std::size_t, std::size_t>> pairs,
    const VisitDistanceOptions& options = {});

}  // namespace groundloop
