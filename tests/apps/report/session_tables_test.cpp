#include "apps/report/session_tables.hpp"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

using testing::TemporaryFolder;

std::filesystem::path written(const TemporaryFolder& folder, const std::string& text) {
  const std::filesystem::path file = folder / "table.csv";
  std::ofstream(file) << text;
  return file;
}

TEST(SessionTables, OdometryQualityIsFoundByTheNamesOfItsColumns) {
  const TemporaryFolder folder;
  const auto rows = read_odometry_quality(
      written(folder,
              "scan,state,added_later,piece,correspondences,inlier_share,residual_m,"
              "sigma_tx,sigma_ty,sigma_tz,sigma_rx,sigma_ry,sigma_rz\n"
              "0,good,9,0,1200,0.8,0.05,0.01,0.02,0.03,0.001,0.002,0.003\n"
              "1,lost,9,1,,,,,,,,,\n"));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].state, "good");
  EXPECT_EQ(rows[0].correspondences, 1200.0);
  EXPECT_EQ(rows[0].sigma[5], 0.003);
  EXPECT_EQ(rows[1].piece, 1);
  EXPECT_TRUE(std::isnan(rows[1].residual_m));  // not computed
}

TEST(SessionTables, UncertaintyIsTheUpperTriangleRowByRow) {
  const TemporaryFolder folder;
  std::string text = "map";
  std::string row = "3";
  for (int i = 0; i < 21; ++i) {
    text += ",c" + std::to_string(i);
    row += "," + std::to_string(i);
  }
  const auto rows = read_uncertainty(written(folder, text + "\n" + row + "\n"));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].map, 3);
  EXPECT_EQ(rows[0].covariance(0, 5), 5.0);
  EXPECT_EQ(rows[0].covariance(1, 1), 6.0);
  EXPECT_EQ(rows[0].covariance(5, 5), 20.0);
  EXPECT_EQ(rows[0].covariance, rows[0].covariance.transpose());
}

TEST(SessionTables, AFileThatIsNotThereHasNoRows) {
  const TemporaryFolder folder;
  EXPECT_TRUE(read_pieces(folder / "pieces.csv").empty());
  EXPECT_TRUE(read_scan_closures(folder / "scan_closures.csv").empty());
}

TEST(SessionTables, DamageIsNamedWithFileAndPlace) {
  const TemporaryFolder folder;
  const auto fault = [&](const std::string& text) {
    try {
      (void)read_pieces(written(folder, text));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  const std::string header = "piece,first_scan,last_scan,frame,joined_by,reason\n";
  EXPECT_NE(fault("piece,first_scan\n").find("no column 'last_scan'"), std::string::npos);
  EXPECT_NE(fault(header + "0,0,9,0,start,\n1,x,19,0,closure,gap\n").find("table.csv:3"),
            std::string::npos);
  EXPECT_NE(fault(header + "0,0\n").find("table.csv:2"), std::string::npos);
}

}  // namespace
}  // namespace groundloop::apps
