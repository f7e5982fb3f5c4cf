// Finds the values of a pose graph that cost least near those it has, with Ceres: every factor is
// one of its cost functions, by way of its linearise(); Levenberg-Marquardt on sparse normal
// equations, nearly undamped while it succeeds.
#pragma once

#include <string>
#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop {

struct SolveOptions {
  int max_iterations = 200;
  double function_tolerance = 1e-7;  ///< relative decrease of the cost that ends a solve
};

struct SolveReport {
  double cost = 0;
  int iterations = 0;
  bool converged = false;
  std::string termination;
};

/// Overwrites the graph's values by the solution; poses with `held[i]`, of which each component
/// needs one or a prior, stay. Rejected edges are left out. The same bytes for every number of
/// threads.
SolveReport solve(PoseGraph& graph, const std::vector<char>& held, const SolveOptions& options,
                  const Progress& progress = {});

}  // namespace groundloop
