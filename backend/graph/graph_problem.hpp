// A pose graph as a Ceres problem: between residuals whitened by their information, poses on SE(3)
// with perturbations on the right, fixed vertices constant. Internal to the optimiser; Ceres stays
// out of this header.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop {

struct SolveOptions {
  int max_iterations = 200;
  double function_tolerance = 1e-7;
};

struct SolveReport {
  double cost = 0;
  int iterations = 0;
  bool converged = false;
  std::string termination;
};

class GraphProblem {
 public:
  /// Holds references to `graph`, which must outlive it and keep its vertices and edges in place.
  /// Rejected edges are not part of the problem; weights are read anew by every solve.
  /// `fixed[i]` holds vertex i.
  GraphProblem(PoseGraph& graph, const std::vector<EdgeEnds>& ends, const std::vector<char>& fixed);
  ~GraphProblem();
  GraphProblem(const GraphProblem&) = delete;
  GraphProblem& operator=(const GraphProblem&) = delete;

  /// Levenberg-Marquardt from the graph's poses, which it overwrites by the solution.
  SolveReport solve(const SolveOptions& options, const Progress& progress = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace groundloop
