#include "backend/judging/graph_evidence.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "backend/graph/gauge.hpp"
#include "backend/graph/graph_problem.hpp"
#include "backend/judging/closure_groups.hpp"

namespace groundloop {
namespace {

double log_determinant(const Matrix6d& positive) {
  return positive.ldlt().vectorD().array().log().sum();
}

// Logarithm of the determinant of the graph's information about its free poses.
double log_determinant_of_hessian(const PoseGraph& graph, const std::vector<EdgeEnds>& ends) {
  const std::vector<char> fixed = gauge(graph, connected_components(graph, ends));
  std::vector<int> slot(fixed.size());
  int free = 0;
  for (std::size_t i = 0; i < fixed.size(); ++i) slot[i] = fixed[i] ? -1 : 6 * free++;
  std::vector<Eigen::Triplet<double, int>> triplets;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (edge.rejected) continue;
    Matrix6d J_from;
    Matrix6d J_to;
    between_residual(graph.vertices[ends[k].from].pose, graph.vertices[ends[k].to].pose,
                     edge.T_from_to, J_from, J_to);
    const Matrix6d information =
        edge.kind == EdgeKind::closure ? bounded_information(edge.information) : edge.information;
    const auto add = [&](int row, int column, const Matrix6d& block) {
      if (row < 0 || column < 0) return;
      for (int c = 0; c < 6; ++c) {
        for (int r = 0; r < 6; ++r) triplets.emplace_back(row + r, column + c, block(r, c));
      }
    };
    const int a = slot[ends[k].from];
    const int b = slot[ends[k].to];
    add(a, a, J_from.transpose() * information * J_from);
    add(b, b, J_to.transpose() * information * J_to);
    add(a, b, J_from.transpose() * information * J_to);
    add(b, a, J_to.transpose() * information * J_from);
  }
  Eigen::SparseMatrix<double> H(6 * free, 6 * free);
  H.setFromTriplets(triplets.begin(), triplets.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(H);
  return factor.vectorD().array().log().sum();
}

}  // namespace

double log_marginal_density(PoseGraph graph, const std::vector<EdgeEnds>& ends) {
  const std::vector<char> fixed = gauge(graph, connected_components(graph, ends));
  GraphProblem(graph, ends, fixed).solve({50, 1e-6});
  double information = 0.0;
  int surplus = 0;  // edges beyond one a free pose
  for (const GraphEdge& edge : graph.edges) {
    if (edge.rejected) continue;
    ++surplus;
    information += log_determinant(
        edge.kind == EdgeKind::closure ? bounded_information(edge.information) : edge.information);
  }
  for (const char f : fixed) surplus -= f ? 0 : 1;
  return -cost(graph) - 0.5 * (log_determinant_of_hessian(graph, ends) - information) -
         3.0 * std::log(2.0 * std::numbers::pi) * surplus;
}

}  // namespace groundloop
