#include "backend/session/uncertainty_table.hpp"

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

TEST(UncertaintyTable, IsReadAsItWasWritten) {
  const testing::TemporaryFolder folder;
  Matrix6d covariance = Matrix6d::Random();
  covariance = (covariance * covariance.transpose()).eval();
  write_uncertainty(folder / "u.csv", {Matrix6d::Zero(), covariance});
  const std::vector<Matrix6d> read = read_uncertainty(folder / "u.csv");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0], Matrix6d::Zero());
  EXPECT_EQ(read[1], covariance.selfadjointView<Eigen::Upper>().toDenseMatrix());
  EXPECT_TRUE(
      read_text(folder / "u.csv").starts_with("map,cov_tx_tx,cov_tx_ty,cov_tx_tz,cov_tx_rx"));
}

TEST(UncertaintyTable, OneThatIsCutOffIsRefused) {
  const testing::TemporaryFolder folder;
  write_uncertainty(folder / "u.csv", {Matrix6d::Identity()});
  const std::string text = read_text(folder / "u.csv");
  write_text_atomically(folder / "u.csv", text.substr(0, text.size() - 12));
  EXPECT_THROW((void)read_uncertainty(folder / "u.csv"), InputError);
  write_text_atomically(folder / "u.csv", "map\n");
  EXPECT_THROW((void)read_uncertainty(folder / "u.csv"), InputError);
}

}  // namespace
}  // namespace groundloop
