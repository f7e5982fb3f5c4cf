#include "backend/graph/solver.hpp"

#include <algorithm>
#include <cmath>

#include "backend/graph/normal_equations.hpp"

namespace groundloop {
namespace {

constexpr double kFirstDamping = 1e-6;  // once a step fails; of the diagonal
constexpr double kLeastDamping = 1e-10;
constexpr double kMostDamping = 1e12;

// The values of a graph, to go back to.
struct Values {
  std::vector<GraphVertex> vertices;
  std::vector<Bend> bends;
  std::vector<Eigen::Vector3d> ups;
  explicit Values(const PoseGraph& graph)
      : vertices(graph.vertices), bends(graph.bends), ups(graph.ups) {}
  void restore(PoseGraph& graph) const {
    graph.vertices = vertices;
    graph.bends = bends;
    graph.ups = ups;
  }
};

class Solver {
 public:
  Solver(PoseGraph& graph, const std::vector<char>& held, const SolveOptions& options)
      : graph_(graph), options_(options), equations_(graph, held) {
    report_.cost = equations_.assemble(graph);
    report_.termination = "the iterations were used up";
  }

  SolveReport run(const Progress& progress) {
    while (report_.iterations < options_.max_iterations && damping_ <= kMostDamping) {
      if (progress) {
        progress("optimisation", static_cast<std::size_t>(report_.iterations),
                 static_cast<std::size_t>(options_.max_iterations));
      }
      ++report_.iterations;
      if (!equations_.matrix().factorise(damping_) || !step()) {
        damping_ = std::max(10.0 * damping_, kFirstDamping);
        if (damping_ > kMostDamping) report_.termination = "no step lowers the cost";
        continue;
      }
      if (report_.converged) break;
      equations_.assemble(graph_);
      if (damping_ == 0.0 && ends_with_the_same_factor()) break;
      damping_ = damping_ > kLeastDamping ? 0.1 * damping_ : 0.0;
    }
    return report_;
  }

 private:
  [[nodiscard]] bool is_small(double decrease) const {
    return std::abs(decrease) <= options_.function_tolerance * report_.cost;
  }

  // Goes to the minimum of the model; back, and false, where the cost rises. At the minimum
  // rounding alone may raise it.
  bool step() {
    const Eigen::VectorXd move = equations_.matrix().solve(-equations_.gradient());
    const Values before(graph_);
    equations_.apply(move, graph_);
    const double now = move.allFinite() ? cost(graph_) : std::nan("");
    const double decrease = report_.cost - now;
    if (!(decrease > 0.0 || is_small(decrease))) {
      before.restore(graph_);
      return false;
    }
    if (is_small(decrease)) end();
    report_.cost = now;
    return true;
  }

  // Near the minimum the last factor still tells how far the cost would fall: where that is too
  // little for another iteration, its step is the last.
  bool ends_with_the_same_factor() {
    const Eigen::VectorXd move = equations_.matrix().solve(-equations_.gradient());
    if (!is_small(-0.5 * move.dot(equations_.gradient()))) return false;
    step();
    end();
    return true;
  }

  void end() {
    report_.converged = true;
    report_.termination = "the cost no longer falls";
  }

  PoseGraph& graph_;
  const SolveOptions& options_;
  NormalEquations equations_;
  SolveReport report_;
  double damping_ = 0.0;
};

}  // namespace

SolveReport solve(PoseGraph& graph, const std::vector<char>& held, const SolveOptions& options,
                  const Progress& progress) {
  return Solver(graph, held, options).run(progress);
}

}  // namespace groundloop
