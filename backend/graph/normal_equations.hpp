// The normal equations of a pose graph about its present values: what the evidence of scales and
// covariances are read from, once Ceres has solved it (solver.hpp). Factors are linearised in
// parallel and added in order.
#pragma once

#include <vector>

#include "backend/graph/block_cholesky.hpp"
#include "backend/graph/factors.hpp"

namespace groundloop {

class NormalEquations {
 public:
  /// Lays out the factors of `graph` that count; poses with `held[i]` are no unknowns.
  NormalEquations(const PoseGraph& graph, const std::vector<char>& held);

  /// Fills matrix and gradient about the graph's values, of the same factors as before; values and
  /// weights may have changed. Returns the cost.
  double assemble(const PoseGraph& graph);

  [[nodiscard]] BlockCholesky& matrix() { return matrix_; }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// Block of a variable in the matrix, -1 where it is held.
  [[nodiscard]] int block_of(int variable) const { return block_of_[variable]; }
  /// First row of a variable in gradient and solutions, -1 where it is held.
  [[nodiscard]] int first_row_of(int variable) const {
    return block_of_[variable] < 0 ? -1 : first_row_[block_of_[variable]];
  }

 private:
  struct Layout;
  explicit NormalEquations(Layout layout);

  std::vector<int> block_of_;   // by variable
  std::vector<int> first_row_;  // by block
  std::vector<int> sizes_;
  BlockCholesky matrix_;
  Eigen::VectorXd gradient_;
};

}  // namespace groundloop
