// Against dense algebra: blocks of 6, 2 and 3 rows, in an order of elimination of its own.
#include "backend/graph/block_cholesky.hpp"

#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace groundloop {
namespace {

using Eigen::MatrixXd;

class RandomBlocks : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    std::mt19937 generator(static_cast<unsigned>(GetParam()));
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const int n = 3 + GetParam() * 7;
    for (int i = 0; i < n; ++i) sizes_.push_back(i % 5 == 4 ? 2 : i % 7 == 6 ? 3 : 6);
    for (const int size : sizes_) start_.push_back(start_.back() + size);
    // A chain, and chords in both directions; one of them twice.
    for (int i = 1; i < n; ++i) pairs_.emplace_back(i - 1, i);
    for (int k = 0; k < n / 2; ++k) {
      const int i = static_cast<int>(generator() % n), j = static_cast<int>(generator() % n);
      if (i != j) pairs_.emplace_back(i, j);
    }
    pairs_.push_back(pairs_.front());
    cholesky_ = std::make_unique<BlockCholesky>(sizes_, pairs_);
    dense_ = MatrixXd::Zero(start_.back(), start_.back());
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto [i, j] = pairs_[k];
      const MatrixXd block =
          MatrixXd::NullaryExpr(sizes_[i], sizes_[j], [&] { return uniform(generator); });
      cholesky_->add_pair(k, block);
      dense_.block(start_[i], start_[j], sizes_[i], sizes_[j]) += block;
      dense_.block(start_[j], start_[i], sizes_[j], sizes_[i]) += block.transpose();
    }
    for (int i = 0; i < n; ++i) {
      const MatrixXd block = 40.0 * MatrixXd::Identity(sizes_[i], sizes_[i]);
      cholesky_->add_diagonal(i, block);
      dense_.block(start_[i], start_[i], sizes_[i], sizes_[i]) += block;
    }
  }

  std::vector<int> sizes_, start_{0};
  std::vector<std::pair<int, int>> pairs_;
  std::unique_ptr<BlockCholesky> cholesky_;
  MatrixXd dense_;
};

TEST_P(RandomBlocks, SolvesAsDenseAlgebraDoes) {
  ASSERT_TRUE(cholesky_->factorise());
  const MatrixXd right = MatrixXd::Random(dense_.rows(), 3);
  EXPECT_LT((dense_ * cholesky_->solve(right) - right).norm(), 1e-9);
  const MatrixXd L = dense_.llt().matrixL();
  EXPECT_NEAR(cholesky_->log_determinant(), 2.0 * L.diagonal().array().log().sum(), 1e-8);
}

TEST_P(RandomBlocks, InvertsWithinThePattern) {
  ASSERT_TRUE(cholesky_->factorise());
  cholesky_->invert_pattern();
  const MatrixXd inverse = dense_.inverse();
  const auto expect_block = [&](int i, int j) {
    const MatrixXd expected = inverse.block(start_[i], start_[j], sizes_[i], sizes_[j]);
    EXPECT_LT((cholesky_->inverse_block(i, j) - expected).norm(), 1e-10) << i << " " << j;
  };
  for (int i = 0; i < static_cast<int>(sizes_.size()); ++i) expect_block(i, i);
  for (const auto& [i, j] : pairs_) {
    expect_block(i, j);
    expect_block(j, i);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RandomBlocks, ::testing::Values(0, 1, 5, 20));

TEST(BlockCholesky, SaysThatAMatrixIsNotPositiveDefinite) {
  BlockCholesky cholesky({2, 2}, {{0, 1}});
  cholesky.add_diagonal(0, Eigen::Matrix2d::Identity());
  cholesky.add_diagonal(1, Eigen::Matrix2d::Identity());
  cholesky.add_pair(0, 2.0 * Eigen::Matrix2d::Identity());
  EXPECT_FALSE(cholesky.factorise());
}

TEST(BlockCholesky, AcceptsNothing) {
  BlockCholesky cholesky({}, {});
  EXPECT_TRUE(cholesky.factorise());
  EXPECT_EQ(cholesky.solve(MatrixXd(0, 1)).rows(), 0);
}

}  // namespace
}  // namespace groundloop
