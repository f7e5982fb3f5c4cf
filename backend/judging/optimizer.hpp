// Optimisation of a pose graph: initialisation (the graph's guess or chordal relaxation, whichever
// costs less), Levenberg-Marquardt, and, on request, robust
// solving that gives every closure a weight and a verdict. The conventions of cost and information
// are those of pose_graph.hpp.
#pragma once

#include <string>
#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop {

struct OptimizerOptions {
  std::string initialisation = "auto";
  bool robust = false;
  double inlier_probability = 0.99;
  int max_iterations = 200;
  double function_tolerance = 1e-6;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("initialisation", self.initialisation, Choices{"auto", "guess", "chordal"}, "",
          "where the solver starts; auto takes the start of lower cost, since from a poor guess it "
          "would end in a local minimum");
    field("robust", self.robust, OnOff{}, "", "judge the closures and leave false ones out");
    field("inlier_probability", self.inlier_probability, Range{0.5, 0.999999}, "",
          "chi-square quantile (6 degrees of freedom) below which a closure counts as true");
    field("max_iterations", self.max_iterations, Range{1, 10000}, "",
          "iterations of one solve; graphs met in practice take 5 to 50");
    field("function_tolerance", self.function_tolerance, Range{0.0, 1.0}, "",
          "relative decrease of the cost that ends a solve");
  }
};

/// Busy seconds of each phase.
struct OptimizationTimes {
  double initialisation = 0;
  double robust = 0;
  double solve = 0;
  double total = 0;
};

struct OptimizationSummary {
  double cost_before = 0;  ///< at the graph's guess, all edges that were not rejected before
  double cost_after = 0;   ///< at the solution, each edge with its weight, rejected ones left out
  double chi2_g2o = 0;     ///< at the solution, over the same edges
  int iterations = 0;      ///< of the last solve
  int robust_steps = 0;    ///< of graduated non-convexity; 0 where not robust
  std::string initialisation;  ///< "guess" or "chordal", as used
  std::string termination;     ///< why the last solve ended
  bool converged = false;
  int components = 0;                       ///< parts of the graph; each has a gauge of its own
  std::vector<std::size_t> rejected_edges;  ///< positions in PoseGraph::edges, rising
  OptimizationTimes seconds;
};

/// Optimises the poses in place. In every connected component without a fixed vertex the first
/// vertex is held where it is. With `robust`, edges of kind closure get their weight and `rejected`
/// from the solution; otherwise both are taken as they are. Deterministic: equal graphs give equal
/// bytes, whatever the number of threads. Throws InputError as check_graph() does.
OptimizationSummary optimize(PoseGraph& graph, const OptimizerOptions& options,
                             const Progress& progress = {});

}  // namespace groundloop
