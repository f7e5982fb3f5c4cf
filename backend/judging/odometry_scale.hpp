// How much better or worse odometry is than its stated drift, found from the closures. For each of
// a row of scales the closures are judged (robust.hpp), and the verdict is weighed by its evidence:
// the density of what the accepted closures measured under odometry of that scale, against that of
// false closures, which claim any pose; a group of neighbours that agree counts as one false event
// (closure_groups.hpp). Too small a scale cannot explain true closures, too large a one makes their
// agreement unlikely; either loses evidence.
#pragma once

#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "backend/judging/robust.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop {

struct ScaleOptions {
  bool estimate = true;              ///< false: the stated drift is the only scale tried
  bool pairwise_consistency = true;  ///< try the largest consistent set where many are rejected
  RobustOptions robust;
};

struct ScaleTrial {
  double scale = 1.0;
  double log_evidence = 0.0;
  int accepted = 0;
  /// Positions of edges that the pairwise check (pairwise_consistency.hpp) left out beforehand.
  std::vector<std::size_t> inconsistent;
};

struct OdometryScale {
  double scale = 1.0;  ///< factor on the odometry's standard deviations
  std::size_t best = 0;
  std::vector<ScaleTrial> trials;  ///< empty where there was nothing to find
};

/// Scale of the odometry edges of `graph`, 1 where it has no closures or where its odometry falls
/// into parts. Deterministic; the graph stays as it is.
[[nodiscard]] OdometryScale estimate_odometry_scale(const PoseGraph& graph,
                                                    const ScaleOptions& options = {},
                                                    const Progress& progress = {});

/// Multiplies the standard deviations of the odometry edges.
void scale_odometry(PoseGraph& graph, double scale);

}  // namespace groundloop
