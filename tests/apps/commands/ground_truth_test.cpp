// Ground truth in other frames than the sensor's, as users have it: recognised, said, overruled.
#include "apps/commands/ground_truth.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/ways.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::run_command;
using testing::TemporaryFolder;

std::string matrix_rows(const Pose& pose) {
  std::string text;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) text += to_text(pose.matrix()(r, c)) + " ";
  }
  return text;
}

// KITTI's layout: an estimate of the LiDAR, and poses of the camera beside its calib.txt.
class KittiTruth : public ::testing::Test {
 protected:
  KittiTruth() {
    const testing::Ways ways = testing::ways(testing::camera_lidar(), 1.0, false);
    std::string estimate;
    std::string truth;
    for (std::size_t i = 0; i < ways.truth.size(); ++i) {
      estimate += matrix_rows(ways.estimate[i]) + "\n";
      truth += matrix_rows(ways.truth[i]) + "\n";
    }
    write_text_atomically(folder_ / "estimate.kitti", estimate);
    write_text_atomically(folder_ / "poses" / "00.txt", truth);
    write_text_atomically(folder_ / "alone.txt", truth);
    write_text_atomically(folder_ / "sequences" / "00" / "calib.txt",
                          "P0: 1 2 3\nTr: " + matrix_rows(testing::camera_lidar()) + "\n");
    write_text_atomically(folder_ / "frame.txt",
                          matrix_rows(testing::camera_lidar()) + "0 0 0 1\n");
  }

  // Rotation errors come out as odometry's, some degrees, or as the camera's turn of 120.
  nlohmann::json evaluate(const std::string& truth, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"evaluate",
                                       "trajectory",
                                       "--json",
                                       "--estimate",
                                       (folder_ / "estimate.kitti").string(),
                                       "--ground-truth",
                                       (folder_ / truth).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_command(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    said_ = result.standard_error;
    return nlohmann::json::parse(result.standard_output);
  }

  static double rotation_error(const nlohmann::json& json) {
    return json.at("ape").at("rotation_deg").at("mean").get<double>();
  }

  TemporaryFolder folder_;
  std::string said_;
};

TEST_F(KittiTruth, IsTheCamerasWhereItsCalibrationLiesBesideIt) {
  const nlohmann::json json = evaluate("poses/00.txt");
  EXPECT_LT(rotation_error(json), 5.0);
  EXPECT_NE(said_.find("camera"), std::string::npos);
  EXPECT_NE(said_.find("calib.txt"), std::string::npos);
  EXPECT_FALSE(json.at("ground_truth").at("found_from_motion").get<bool>());
  EXPECT_NEAR(json.at("ground_truth").at("rotation_deg").get<double>(), 120.0, 1e-6);
}

TEST_F(KittiTruth, IsFoundFromTheMotionWhereNothingLiesBesideIt) {
  const nlohmann::json json = evaluate("alone.txt");
  EXPECT_LT(rotation_error(json), 5.0);
  EXPECT_TRUE(json.at("ground_truth").at("found_from_motion").get<bool>());
  EXPECT_NE(said_.find("turned by 120"), std::string::npos) << said_;
  EXPECT_NE(said_.find("--truth-frame"), std::string::npos);
}

TEST_F(KittiTruth, IsWhatTheUserSays) {
  EXPECT_LT(
      rotation_error(evaluate("alone.txt", {"--truth-frame", (folder_ / "frame.txt").string()})),
      5.0);
  EXPECT_LT(rotation_error(evaluate("poses/00.txt", {"--truth-frame", "camera"})), 5.0);
  EXPECT_GT(rotation_error(evaluate("poses/00.txt", {"--truth-frame", "sensor"})), 90.0);
  EXPECT_NE(said_.find("does not fit"), std::string::npos);
}

TEST_F(KittiTruth, AFrameThatIsNotToBeHadIsRefused) {
  const auto refuse = [&](const std::string& frame, const std::vector<std::string>& parts) {
    testing::expect_input_error(
        run_command({"evaluate", "trajectory", "--estimate", (folder_ / "estimate.kitti").string(),
                     "--ground-truth", (folder_ / "alone.txt").string(), "--truth-frame", frame}),
        parts);
  };
  refuse("camera", {"calib.txt", "4x4"});
  refuse("/nonexistent.txt", {"/nonexistent.txt"});
  write_text_atomically(folder_ / "three.txt", "1 2 3\n");
  refuse((folder_ / "three.txt").string(), {"3 numbers"});
  write_text_atomically(folder_ / "sheared.txt", "1 1 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  refuse((folder_ / "sheared.txt").string(), {"sheared.txt"});
}

}  // namespace
}  // namespace groundloop
