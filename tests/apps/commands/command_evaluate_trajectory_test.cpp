#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "frontend/core/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

Outcome evaluate(const testing::TemporaryFolder& folder, const std::string& arguments) {
  const std::string out = (folder / "out").string();
  const std::string err = (folder / "err").string();
  const std::string command = std::string(GROUNDLOOP_BINARY) + " evaluate trajectory " + arguments +
                              " >" + out + " 2>" + err;
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
}

std::string write(const testing::TemporaryFolder& folder, const std::string& name,
                  const std::string& text) {
  std::ofstream(folder / name) << text;
  return (folder / name).string();
}

constexpr const char* kTum =
    "# stamp tx ty tz qx qy qz qw\n0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n0.2 2 1 0 0 0 0 1\n";
constexpr const char* kKitti = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n";

TEST(EvaluateTrajectoryCommand, PrintsOneJsonObject) {
  const testing::TemporaryFolder folder;
  const std::string file = write(folder, "a.tum", kTum);
  const Outcome outcome = evaluate(folder, "--json --estimate " + file + " --ground-truth " + file);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["pairs"], 3);
  EXPECT_EQ(json["alignment"], "se3");
  for (const char* key : {"rmse", "mean", "median", "std", "min", "max"}) {
    EXPECT_NEAR(json["ape"]["translation_m"][key], 0.0, 1e-9) << key;
    EXPECT_NEAR(json["ape"]["rotation_deg"][key], 0.0, 1e-5) << key;
  }
  EXPECT_TRUE(json["kitti"].contains("translation_percent"));
  EXPECT_TRUE(json["kitti"].contains("rotation_deg_per_m"));
}

TEST(EvaluateTrajectoryCommand, PrintsTheDistanceOfTwoVisits) {
  // Out and back along 80 m; the estimate has the way back 0.25 m higher.
  const testing::TemporaryFolder folder;
  std::string truth, estimate;
  for (int i = 0; i <= 160; ++i) {
    const std::string place = std::to_string(i) + " " + std::to_string(i <= 80 ? i : 160 - i);
    truth += place + " 0 0 0 0 0 1\n";
    estimate += place + (i <= 80 ? " 0 0" : " 0 0.25") + " 0 0 0 1\n";
  }
  const std::string files = "--estimate " + write(folder, "estimate.tum", estimate) +
                            " --ground-truth " + write(folder, "truth.tum", truth);
  const Outcome outcome = evaluate(folder, "--json " + files);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto visits = nlohmann::json::parse(outcome.out)["visits"];
  // Of the scans more than 50 m from the turn, which have 100 m between them and their like.
  EXPECT_GT(visits["by_way"]["pairs"], 200);
  EXPECT_NEAR(visits["by_way"]["median_m"], 0.25, 1e-6);
  EXPECT_NEAR(visits["by_way"]["p95_m"], 0.25, 1e-6);
  EXPECT_GT(visits["by_time"]["pairs"], visits["by_way"]["pairs"]);
  EXPECT_NE(evaluate(folder, files).out.find("0.2500 m median"), std::string::npos);
}

TEST(EvaluateTrajectoryCommand, FailsWithOneLineAndCode2) {
  const testing::TemporaryFolder folder;
  const std::string tum = write(folder, "a.tum", kTum);
  const std::string late = write(folder, "late.tum", "100 0 0 0 0 0 0 1\n");
  const std::string kitti = write(folder, "a.kitti", kKitti);
  const std::string longer = write(folder, "b.kitti", std::string(kKitti) + kKitti);
  const std::string columns = write(folder, "c.txt", "1 2 3\n");
  const std::string empty = write(folder, "d.txt", "# nothing\n");
  for (const auto& [estimate, truth] : {std::pair{tum, late},
                                        {kitti, longer},
                                        {tum, kitti},
                                        {columns, tum},
                                        {empty, tum},
                                        {tum + ".absent", tum}}) {
    const Outcome outcome = evaluate(folder, "--estimate " + estimate + " --ground-truth " + truth);
    EXPECT_EQ(outcome.code, 2) << estimate << " " << truth;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_EQ(evaluate(folder, "--estimate " + tum).code, 2);
  EXPECT_EQ(evaluate(folder, "--align foo --estimate " + tum + " --ground-truth " + tum).code, 2);
}

}  // namespace
}  // namespace groundloop
