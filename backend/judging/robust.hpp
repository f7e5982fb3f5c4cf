// Which closures to believe: graduated non-convexity with truncated least squares (Yang, Antonante,
// Tzoumas, Carlone, RA-L 2020) over the closures of a pose graph, odometry trusted. It starts from
// the odometry alone and judges on the graph with its odometry runs condensed; the poses of the
// full graph are the optimiser's business.
//
// Trust in odometry is as good as its information: where odometry errs three times as much as its
// information says, true closures contradict it and are rejected with the false ones; where it is
// believed too little, a group of false closures that agree with each other may outvote the true
// ones near it. odometry_scale.hpp finds out; pairwise_consistency.hpp is a check that needs no
// solution.
#pragma once

#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop {

struct RobustOptions {
  double inlier_probability = 0.99;  ///< chi-square quantile of a true closure's residual
};

struct RobustReport {
  int steps = 0;  ///< of graduation
  int accepted = 0;
  int rejected = 0;
};

/// Quantile of the chi-square distribution with 6 degrees of freedom.
[[nodiscard]] double chi_square_quantile_6(double probability);

/// Sets weight and `rejected` of every closure that was not rejected before. Poses stay.
RobustReport judge_closures(PoseGraph& graph, const RobustOptions& options,
                            const Progress& progress = {});

}  // namespace groundloop
