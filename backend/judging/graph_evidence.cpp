#include "backend/judging/graph_evidence.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>

#include "backend/graph/normal_equations.hpp"
#include "backend/graph/relative_pose.hpp"
#include "backend/graph/solver.hpp"

namespace groundloop {
namespace {

// Rows of a factor's residual, and the logarithm of the determinant of their information.
struct Measured {
  int rows = 0;
  double log_information = 0.0;
};

double log_determinant(const Matrix6d& positive) {
  return positive.ldlt().vectorD().array().log().sum();
}

Measured measured(const GraphEdge& edge) { return {6, log_determinant(edge.information)}; }
Measured measured(const VerticalFactor& vertical) {
  const Eigen::Matrix2d square = vertical.whitening * vertical.whitening.transpose();
  return {2, std::log(square.determinant()) + 2.0 * std::log(vertical.weight)};
}
Measured measured(const PosePrior& prior) { return {6, log_determinant(prior.information)}; }
Measured measured(const BendPrior& prior) {
  return {2, -2.0 * prior.deviation.array().log().sum()};
}

}  // namespace

double log_marginal_density(PoseGraph graph) {
  const std::vector<char> held = gauge(graph);
  double log_information = 0.0;
  int surplus = 0;  // rows beyond one an unknown
  for (GraphEdge& edge : graph.edges) {
    const bool open = edge.information.llt().info() != Eigen::Success;
    if (open || edge.kind == EdgeKind::closure)
      edge.information = bounded_information(edge.information);
  }
  for_each_kind(graph, [&](const auto& factors) {
    for (const auto& factor : factors) {
      if (!counts(factor)) continue;
      const Measured m = measured(factor);
      surplus += m.rows;
      log_information += m.log_information;
    }
  });
  const double minimum = solve(graph, held, {50, 1e-6}).cost;
  NormalEquations equations(graph, held);
  equations.assemble(graph);
  if (!equations.matrix().factorise()) return -std::numeric_limits<double>::infinity();
  surplus -= equations.matrix().rows();
  return -minimum - 0.5 * (equations.matrix().log_determinant() - log_information) -
         0.5 * std::log(2.0 * std::numbers::pi) * surplus;
}

}  // namespace groundloop
