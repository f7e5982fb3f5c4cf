#include "backend/graph/chordal.hpp"

#include <utility>

#include <Eigen/SVD>

#include "backend/graph/block_cholesky.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

// Normal equations with one 3-row block a free vertex; both linear problems have this layout.
class BlockSystem {
 public:
  BlockSystem(const PoseGraph& graph, const std::vector<char>& held)
      : slot_(slots(held)), matrix_(sizes(held), pairs(graph)) {}

  void clear(Eigen::Index columns) {
    matrix_.set_zero();
    right_ = MatrixXd::Zero(matrix_.rows(), columns);
    pair_ = 0;
  }

  // Adds |A x_i - B x_j - c|^2 in the metric M; `known_i` stands for x_i where i is held, `known_j`
  // likewise. Edges in their order.
  void add(int i, int j, const Matrix3d& A, const Matrix3d& B, const Matrix3d& M, const MatrixXd& c,
           const MatrixXd& known_i, const MatrixXd& known_j) {
    const int a = slot_[i];
    const int b = slot_[j];
    const Matrix3d MA = M * A;
    const Matrix3d MB = M * B;
    if (a >= 0) {
      matrix_.add_diagonal(a, A.transpose() * MA);
      right_.middleRows(3 * a, 3) += MA.transpose() * c;
      if (b < 0) right_.middleRows(3 * a, 3) += MA.transpose() * (B * known_j);
    }
    if (b >= 0) {
      matrix_.add_diagonal(b, B.transpose() * MB);
      right_.middleRows(3 * b, 3) -= MB.transpose() * c;
      if (a < 0) right_.middleRows(3 * b, 3) += MB.transpose() * (A * known_i);
    }
    if (a >= 0 && b >= 0) matrix_.add_pair(pair_++, -A.transpose() * MB);
  }

  // Returns false where the matrix is singular.
  [[nodiscard]] bool solve(MatrixXd& x) {
    if (!matrix_.factorise()) return false;
    x = matrix_.solve(right_);
    return x.allFinite();
  }
  [[nodiscard]] int slot(std::size_t vertex) const { return slot_[vertex]; }

 private:
  static std::vector<int> slots(const std::vector<char>& held) {
    std::vector<int> slot(held.size());
    int free = 0;
    for (std::size_t i = 0; i < held.size(); ++i) slot[i] = held[i] ? -1 : free++;
    return slot;
  }
  static std::vector<int> sizes(const std::vector<char>& held) {
    std::vector<int> result;
    for (const char h : held) {
      if (!h) result.push_back(3);
    }
    return result;
  }
  [[nodiscard]] std::vector<std::pair<int, int>> pairs(const PoseGraph& graph) const {
    std::vector<std::pair<int, int>> result;
    for (const GraphEdge& edge : graph.edges) {
      if (edge.rejected || edge.weight == 0.0) continue;
      if (slot_[edge.from] >= 0 && slot_[edge.to] >= 0)
        result.emplace_back(slot_[edge.from], slot_[edge.to]);
    }
    return result;
  }

  std::vector<int> slot_;
  BlockCholesky matrix_;
  MatrixXd right_;
  std::size_t pair_ = 0;
};

// One weight for an edge's rotation: the inverse of its mean variance, from the information given
// that the translation is free.
double rotation_weight(const Matrix6d& information) {
  const Matrix3d rotation = information.bottomRightCorner<3, 3>();
  return rotation.trace() / 3.0;
}

Matrix3d nearest_rotation(const Matrix3d& m) {
  const Eigen::JacobiSVD<Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

bool initialise_chordal(PoseGraph& graph, const std::vector<char>& held) {
  const std::size_t n = graph.vertices.size();
  if (n == 0) return true;
  std::vector<Matrix3d> rotation(n);
  for (std::size_t i = 0; i < n; ++i) rotation[i] = graph.vertices[i].pose.rotation_matrix();

  // Unknown are the transposed rotations X: X_j = R_ij' X_i.
  BlockSystem system(graph, held);
  system.clear(3);
  const Matrix3d zero = Matrix3d::Zero();
  for (const GraphEdge& edge : graph.edges) {
    if (edge.rejected || edge.weight == 0.0) continue;
    const double w = edge.weight * rotation_weight(edge.information);
    system.add(edge.from, edge.to, edge.T_from_to.rotation_matrix().transpose(),
               Matrix3d::Identity(), w * Matrix3d::Identity(), zero,
               rotation[edge.from].transpose(), rotation[edge.to].transpose());
  }
  MatrixXd x;
  if (!system.solve(x)) return false;
  parallel_for(n, 64, [&](std::size_t i) {
    const int slot = system.slot(i);
    if (slot >= 0) rotation[i] = nearest_rotation(x.middleRows<3>(3 * slot).transpose());
  });

  // t_j - t_i = R_i t_ij, in the metric of the measurement's translation.
  system.clear(1);
  for (const GraphEdge& edge : graph.edges) {
    if (edge.rejected || edge.weight == 0.0) continue;
    const Matrix3d to_measurement =
        edge.T_from_to.rotation_matrix().transpose() * rotation[edge.from].transpose();
    const Matrix3d metric = edge.weight * to_measurement.transpose() *
                            edge.information.topLeftCorner<3, 3>() * to_measurement;
    system.add(edge.from, edge.to, -Matrix3d::Identity(), -Matrix3d::Identity(), metric,
               rotation[edge.from] * edge.T_from_to.translation,
               graph.vertices[edge.from].pose.translation,
               graph.vertices[edge.to].pose.translation);
  }
  if (!system.solve(x)) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const int slot = system.slot(i);
    if (slot >= 0) graph.vertices[i].pose = Pose(rotation[i], x.middleRows<3>(3 * slot));
  }
  return true;
}

}  // namespace groundloop
