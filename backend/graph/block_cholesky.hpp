// Sparse symmetric positive definite systems of small dense blocks, as graphs of poses give them:
// ordered by approximate minimum degree over the blocks, factorised by CHOLMOD. From one factor
// come solutions, the determinant, and the blocks of the inverse that covariances are read from.
// One thread, so that bytes do not depend on the number of threads.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace groundloop {

class BlockCholesky {
 public:
  /// A matrix of blocks along the diagonal, `sizes` their rows, and one block below it for each of
  /// `pairs` (two different positions each, in any order; repeated pairs share a block).
  BlockCholesky(std::vector<int> sizes, const std::vector<std::pair<int, int>>& pairs);
  ~BlockCholesky();
  BlockCholesky(const BlockCholesky&) = delete;
  BlockCholesky& operator=(const BlockCholesky&) = delete;

  void set_zero();
  /// Adds to the diagonal block of i, all of it.
  void add_diagonal(int i, const Eigen::Ref<const Eigen::MatrixXd>& block);
  /// Adds `block` where the first of the pair has its rows and the second its columns.
  void add_pair(std::size_t pair, const Eigen::Ref<const Eigen::MatrixXd>& block);

  /// Returns false where the matrix is not positive definite.
  [[nodiscard]] bool factorise();

  // Of the factor; rows of vectors follow the order of blocks given.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  [[nodiscard]] double log_determinant() const;
  /// Computes the inverse within the pattern of the factor; then inverse_block() is to be had for
  /// all diagonal blocks and all pairs.
  void invert_pattern();
  /// Rows of i, columns of j: i == j, or a pair of the pattern.
  [[nodiscard]] Eigen::MatrixXd inverse_block(int i, int j) const;

  [[nodiscard]] int rows() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace groundloop
