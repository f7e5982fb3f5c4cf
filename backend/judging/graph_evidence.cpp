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

double log_determinant(const Matrix6d& positive) {
  return positive.ldlt().vectorD().array().log().sum();
}

}  // namespace

double log_marginal_density(PoseGraph graph) {
  const std::vector<char> held = gauge(graph);
  double log_information = 0.0;
  int surplus = 0;  // edges beyond one a free pose
  for (GraphEdge& edge : graph.edges) {
    if (edge.rejected) continue;
    ++surplus;
    if (edge.kind == EdgeKind::closure) edge.information = bounded_information(edge.information);
    log_information += log_determinant(edge.information);
  }
  for (const char h : held) surplus -= h ? 0 : 1;
  const double minimum = solve(graph, held, {50, 1e-6}).cost;
  NormalEquations equations(graph, held);
  equations.assemble(graph);
  if (!equations.matrix().factorise()) return -std::numeric_limits<double>::infinity();
  return -minimum - 0.5 * (equations.matrix().log_determinant() - log_information) -
         3.0 * std::log(2.0 * std::numbers::pi) * surplus;
}

}  // namespace groundloop
