// Pages of what is judged or solved without a session: a trajectory against its ground truth, a
// pose graph before and after.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html_page.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/graph/pose_graph.hpp"
#include "backend/judging/optimizer.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::apps {

/// `evaluation` is of `estimate` against `truth`.
[[nodiscard]] Page trajectory_page(const std::string& title, const Trajectory& estimate,
                                   const Trajectory& truth, const TrajectoryEvaluation& evaluation,
                                   const TrajectoryEvaluationOptions& options);

/// `before` is where the vertices of `graph` were, in their order.
[[nodiscard]] Page graph_page(const std::string& title, const std::vector<Pose>& before,
                              const PoseGraph& graph, const OptimizationSummary& summary);

}  // namespace groundloop::apps
