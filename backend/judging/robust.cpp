#include "backend/judging/robust.hpp"

#include <algorithm>
#include <cmath>

#include "backend/graph/chains.hpp"
#include "backend/graph/factors.hpp"
#include "backend/graph/odometry_tree.hpp"
#include "backend/graph/solver.hpp"

namespace groundloop {
namespace {

constexpr double kStep = 1.4;       // growth of mu, as Yang et al. recommend
constexpr double kFirstStep = 3.0;  // until the first closure is certain: nothing is decided yet
constexpr int kMaxRounds = 5;
constexpr double kMuOfAnotherRound = 2e-4;  // closures up to 5 000 times the bound take part
constexpr int kMaxSteps = 150;              // mu from 1e-11 to 1e11
constexpr int kIterationsOfAStep = 3;       // the next step moves the weights anyway
constexpr double kToleranceOfAStep = 1e-3;

// Works on the weights of the graph's closures; ends with each 0 or 1.
class GraduatedNonConvexity {
 public:
  GraduatedNonConvexity(PoseGraph& graph, const RobustOptions& options, const Progress& progress)
      : graph_(graph),
        progress_(progress),
        bound_(chi_square_quantile_6(options.inlier_probability)) {
    for (std::size_t k = 0; k < graph.edges.size(); ++k) {
      if (graph.edges[k].kind == EdgeKind::closure) closures_.push_back(k);
    }
  }

  // Returns the number of steps.
  int run() {
    if (closures_.empty()) return 0;
    place_by_odometry();
    const std::vector<double> squared = squared_residuals();
    const double largest = *std::max_element(squared.begin(), squared.end());
    const int steps = graduate(bound_ / std::max(2.0 * largest - bound_, bound_));
    return steps + improve();
  }

 private:
  // Odometry cannot be reached by false closures, whereas a solution with all closures is bent
  // beyond repair by a few tens of percent of false ones.
  void place_by_odometry() {
    const OdometryTree odometry(graph_);
    for (std::size_t i = 0; i < graph_.vertices.size(); ++i) {
      graph_.vertices[i].pose = odometry.pose(static_cast<int>(i));
    }
  }

  // True closures lost on the way, a twisted part of the graph with them, are nearer to this
  // solution than to the odometry: they get another chance, as long as the truncated cost falls.
  int improve() {
    int steps = 0;
    for (int round = 0; round < kMaxRounds; ++round) {
      const PoseGraph best = graph_;
      const double best_cost = truncated_cost();
      steps += graduate(kMuOfAnotherRound);
      if (truncated_cost() < best_cost && verdicts_differ(best)) continue;
      graph_ = best;
      break;
    }
    return steps;
  }

  // From the graph's poses; returns the number of steps.
  int graduate(double mu) {
    std::vector<double> squared = squared_residuals();
    bool certain = false;
    int step = 0;
    while (step < kMaxSteps) {
      const bool binary = set_weights(squared, mu);
      for (const std::size_t k : closures_) certain = certain || graph_.edges[k].weight == 1.0;
      solve();
      squared = squared_residuals();
      ++step;
      if (progress_) progress_("judging closures", static_cast<std::size_t>(step), 0);
      if (binary && verdicts_hold(squared)) break;
      mu *= certain ? kStep : kFirstStep;
    }
    for (const std::size_t k : closures_) {
      graph_.edges[k].weight = graph_.edges[k].weight < 0.5 ? 0.0 : 1.0;
      graph_.edges[k].rejected = graph_.edges[k].weight == 0.0;
    }
    return step;
  }

  // What truncated least squares minimises: a closure costs at most half the bound.
  [[nodiscard]] double truncated_cost() const {
    double sum = cost(graph_);
    for (const std::size_t k : closures_) sum += graph_.edges[k].rejected ? 0.5 * bound_ : 0.0;
    return sum;
  }

  [[nodiscard]] bool verdicts_differ(const PoseGraph& other) const {
    return std::any_of(closures_.begin(), closures_.end(), [&](std::size_t k) {
      return graph_.edges[k].rejected != other.edges[k].rejected;
    });
  }

  // Closures of weight 0 are not part of the problem, which would be as dense as they are many; a
  // part of the graph that only they joined is held where it is.
  void solve() {
    for (const std::size_t k : closures_) graph_.edges[k].rejected = graph_.edges[k].weight == 0.0;
    groundloop::solve(graph_, gauge(graph_), {kIterationsOfAStep, kToleranceOfAStep});
  }

  [[nodiscard]] std::vector<double> squared_residuals() const {
    std::vector<double> squared;
    squared.reserve(closures_.size());
    for (const std::size_t k : closures_) {
      GraphEdge whole = graph_.edges[k];
      whole.weight = 1.0;
      squared.push_back(2.0 * cost(graph_, whole));
    }
    return squared;
  }

  // Weights of truncated least squares (eq. 14 of the paper); returns whether all are 0 or 1.
  bool set_weights(const std::vector<double>& squared, double mu) {
    bool binary = true;
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      double weight = 0.0;
      if (squared[i] <= mu / (mu + 1.0) * bound_) {
        weight = 1.0;
      } else if (squared[i] < (mu + 1.0) / mu * bound_) {
        weight = std::clamp(std::sqrt(bound_ * mu * (mu + 1.0) / squared[i]) - mu, 0.0, 1.0);
        binary = binary && (weight == 0.0 || weight == 1.0);
      }
      graph_.edges[closures_[i]].weight = weight;
    }
    return binary;
  }

  [[nodiscard]] bool verdicts_hold(const std::vector<double>& squared) const {
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      if ((squared[i] <= bound_) != (graph_.edges[closures_[i]].weight == 1.0)) return false;
    }
    return true;
  }

  PoseGraph& graph_;
  const Progress& progress_;
  double bound_;
  std::vector<std::size_t> closures_;
};

}  // namespace

double chi_square_quantile_6(double probability) {
  // For an even number of degrees of freedom the distribution is a finite sum of Poisson terms.
  double low = 0.0;
  double high = 200.0;
  for (int i = 0; i < 100; ++i) {
    const double half = 0.25 * (low + high);
    const double below = 1.0 - std::exp(-half) * (1.0 + half + 0.5 * half * half);
    (below < probability ? low : high) = 2.0 * half;
  }
  return 0.5 * (low + high);
}

RobustReport judge_closures(PoseGraph& graph, const RobustOptions& options,
                            const Progress& progress) {
  CondensedGraph condensed = condense_chains(graph);
  RobustReport report;
  report.steps = GraduatedNonConvexity(condensed.graph, options, progress).run();
  for (std::size_t k = 0; k < condensed.graph.edges.size(); ++k) {
    if (condensed.graph.edges[k].kind != EdgeKind::closure) continue;
    GraphEdge& edge = graph.edges[condensed.edge_of[k]];
    edge.weight = condensed.graph.edges[k].weight;
    edge.rejected = edge.weight == 0.0;
    ++(edge.rejected ? report.rejected : report.accepted);
  }
  return report;
}

}  // namespace groundloop
