#include "backend/judging/optimizer.hpp"

#include <algorithm>
#include <chrono>

#include <spdlog/spdlog.h>

#include "backend/graph/between_factor.hpp"
#include "backend/graph/chordal.hpp"
#include "backend/graph/factors.hpp"
#include "backend/graph/solver.hpp"
#include "backend/judging/robust.hpp"

namespace groundloop {
namespace {

class Stopwatch {
 public:
  // Seconds since construction or the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// Moves the graph to its start; returns the start's name.
std::string initialise(PoseGraph& graph, const std::vector<char>& held,
                       const OptimizerOptions& options) {
  if (options.initialisation == "guess") return "guess";
  const double cost_of_guess = cost(graph);
  const std::vector<GraphVertex> guess = graph.vertices;
  if (!initialise_chordal(graph, held)) {
    spdlog::warn("chordal initialisation: the linear system is singular; starting from the guess");
    return "guess";
  }
  if (options.initialisation == "chordal" || cost(graph) < cost_of_guess) return "chordal";
  graph.vertices = guess;
  return "guess";
}

}  // namespace

OptimizationSummary optimize(PoseGraph& graph, const OptimizerOptions& options,
                             const Progress& progress) {
  validate(options, "optimizer");
  Stopwatch total;
  Stopwatch phase;
  OptimizationSummary summary;
  check_graph(graph);
  summary.cost_before = cost(graph);
  if (options.robust) {
    const RobustReport report = judge_closures(graph, {options.inlier_probability}, progress);
    summary.robust_steps = report.steps;
    if (report.rejected > report.accepted) {
      spdlog::warn("robust solving rejected {} of {} closures", report.rejected,
                   report.rejected + report.accepted);
    }
    summary.seconds.robust = phase.lap();
  }
  const std::vector<int> component = connected_components(graph);
  summary.components =
      component.empty() ? 0 : 1 + *std::max_element(component.begin(), component.end());
  const std::vector<char> held = gauge(graph);
  summary.initialisation = initialise(graph, held, options);
  summary.seconds.initialisation = phase.lap();

  const SolveReport report =
      solve(graph, held, {options.max_iterations, options.function_tolerance}, progress);
  summary.seconds.solve = phase.lap();
  summary.iterations = report.iterations;
  summary.termination = report.termination;
  summary.converged = report.converged;
  summary.cost_after = cost(graph);
  summary.chi2_g2o = chi2_g2o(graph);
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    if (graph.edges[k].rejected) summary.rejected_edges.push_back(k);
  }
  summary.seconds.total = total.lap();
  return summary;
}

}  // namespace groundloop
