#include "backend/graph/chordal.hpp"

#include <array>
#include <utility>

#include <Eigen/CholmodSupport>
#include <Eigen/SVD>
#include <Eigen/SparseCore>

#include "backend/graph/single_threaded_algebra.hpp"

namespace groundloop {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

// Normal equations of a problem with one 3-row block a free vertex. Only the lower triangle is
// kept.
class BlockSystem {
 public:
  BlockSystem(const std::vector<char>& fixed, Eigen::Index columns, std::size_t edges)
      : slot_(fixed.size()), diagonal_() {
    int free = 0;
    for (std::size_t i = 0; i < fixed.size(); ++i) slot_[i] = fixed[i] ? -1 : free++;
    diagonal_.assign(free, Matrix3d::Zero());
    right_ = MatrixXd::Zero(3 * free, columns);
    triplets_.reserve(9 * edges + 6 * free);
  }

  [[nodiscard]] int slot(int vertex) const { return slot_[vertex]; }

  // Adds |A x_i - B x_j - c|^2 in the metric M, given A' M A etc. by the caller's matrices;
  // `known_i` stands for x_i where i is fixed, `known_j` likewise.
  void add(int i, int j, const Matrix3d& A, const Matrix3d& B, const Matrix3d& M, const MatrixXd& c,
           const MatrixXd& known_i, const MatrixXd& known_j) {
    const int a = slot_[i];
    const int b = slot_[j];
    const Matrix3d MA = M * A;
    const Matrix3d MB = M * B;
    if (a >= 0) {
      diagonal_[a] += A.transpose() * MA;
      right_.middleRows(3 * a, 3) += MA.transpose() * c;
      if (b < 0) right_.middleRows(3 * a, 3) += MA.transpose() * (B * known_j);
    }
    if (b >= 0) {
      diagonal_[b] += B.transpose() * MB;
      right_.middleRows(3 * b, 3) -= MB.transpose() * c;
      if (a < 0) right_.middleRows(3 * b, 3) += MB.transpose() * (A * known_i);
    }
    if (a >= 0 && b >= 0) {
      const Matrix3d off = -A.transpose() * MB;
      const bool lower = a > b;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          const int p = 3 * a + row;
          const int q = 3 * b + column;
          triplets_.emplace_back(lower ? p : q, lower ? q : p, off(row, column));
        }
      }
    }
  }

  // Returns false where the matrix is singular.
  bool solve(MatrixXd& x) {
    x = right_;
    if (right_.rows() == 0) return true;
    for (std::size_t i = 0; i < diagonal_.size(); ++i) {
      for (int column = 0; column < 3; ++column) {
        for (int row = column; row < 3; ++row) {
          triplets_.emplace_back(3 * i + row, 3 * i + column, diagonal_[i](row, column));
        }
      }
    }
    SparseMatrix H(right_.rows(), right_.rows());
    H.setFromTriplets(triplets_.begin(), triplets_.end());
    const SingleThreadedAlgebra one_thread;
    Eigen::CholmodDecomposition<SparseMatrix, Eigen::Lower> cholesky;
    cholesky.cholmod().print = 0;
    cholesky.cholmod().nmethods = 1;  // without trying METIS, which gains less than it takes
    cholesky.cholmod().method[0].ordering = CHOLMOD_AMD;
    cholesky.compute(H);
    if (cholesky.info() != Eigen::Success) return false;
    x = cholesky.solve(right_);
    return cholesky.info() == Eigen::Success && x.allFinite();
  }

 private:
  std::vector<int> slot_;
  std::vector<Matrix3d> diagonal_;
  MatrixXd right_;
  std::vector<Eigen::Triplet<double, int>> triplets_;
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

bool initialise_chordal(PoseGraph& graph, const std::vector<EdgeEnds>& ends,
                        const std::vector<char>& fixed) {
  const std::size_t n = graph.vertices.size();
  if (n == 0) return true;
  std::vector<Matrix3d> rotation(n);
  for (std::size_t i = 0; i < n; ++i) rotation[i] = graph.vertices[i].pose.rotation_matrix();

  // Unknown are the transposed rotations X: X_j = R_ij' X_i.
  BlockSystem rotations(fixed, 3, graph.edges.size());
  const Matrix3d zero = Matrix3d::Zero();
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (edge.rejected || edge.weight == 0.0) continue;
    const auto [i, j] = ends[k];
    const double w = edge.weight * rotation_weight(edge.information);
    rotations.add(i, j, edge.T_from_to.rotation_matrix().transpose(), Matrix3d::Identity(),
                  w * Matrix3d::Identity(), zero, rotation[i].transpose(), rotation[j].transpose());
  }
  MatrixXd x;
  if (!rotations.solve(x)) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const int slot = rotations.slot(static_cast<int>(i));
    if (slot >= 0) rotation[i] = nearest_rotation(x.middleRows<3>(3 * slot).transpose());
  }

  // t_j - t_i = R_i t_ij, in the metric of the measurement's translation.
  BlockSystem translations(fixed, 1, graph.edges.size());
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (edge.rejected || edge.weight == 0.0) continue;
    const auto [i, j] = ends[k];
    const Matrix3d to_measurement =
        edge.T_from_to.rotation_matrix().transpose() * rotation[i].transpose();
    const Matrix3d metric = edge.weight * to_measurement.transpose() *
                            edge.information.topLeftCorner<3, 3>() * to_measurement;
    translations.add(i, j, -Matrix3d::Identity(), -Matrix3d::Identity(), metric,
                     rotation[i] * edge.T_from_to.translation, graph.vertices[i].pose.translation,
                     graph.vertices[j].pose.translation);
  }
  if (!translations.solve(x)) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const int slot = translations.slot(static_cast<int>(i));
    if (slot < 0) continue;
    graph.vertices[i].pose = Pose(rotation[i], x.middleRows<3>(3 * slot));
  }
  return true;
}

}  // namespace groundloop
