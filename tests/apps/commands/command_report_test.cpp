// The pages and diagnoses that are made of a finished session, or of files.
#include <fstream>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "frontend/core/files.hpp"
#include "frontend/core/trajectory.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::expect_input_error;
using testing::run_command;
using testing::TemporaryFolder;

// One short run for all.
class SessionPages : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const auto result = run_command(
        {"run", "sim:town?sensor=spin16&length=40&seed=3", "--out", session().string(), "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static fs::path session() { return *folder_ / "out"; }
  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> SessionPages::folder_;

TEST_F(SessionPages, ReportFromTheFolderIsTheRunsOwn) {
  const TemporaryFolder folder;
  const auto again =
      run_command({"report", session().string(), "--out", (folder / "again.html").string()});
  ASSERT_EQ(again.exit_code, 0) << again.standard_error;
  EXPECT_EQ(read_text(folder / "again.html"), read_text(session() / "report.html"));
}

TEST_F(SessionPages, ReportWithoutPointsIsSmall) {
  const TemporaryFolder folder;
  const auto result = run_command({"report", session().string(), "--points", "0", "--closures", "0",
                                   "--out", (folder / "small.html").string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_LT(fs::file_size(folder / "small.html"), 1U << 20);
  EXPECT_GT(fs::file_size(session() / "report.html"), fs::file_size(folder / "small.html"));
}

TEST_F(SessionPages, GroundTruthThatCannotBeReadIsNamed) {
  expect_input_error(run_command({"report", session().string(), "--ground-truth", "nowhere.tum"}),
                     {"nowhere.tum"});
}

TEST_F(SessionPages, AnAlteredTruthShowsInTheVerdict) {
  const TemporaryFolder folder;
  // The session's own solution, stretched threefold: no SE(3) alignment brings that together.
  Trajectory truth = read_tum(session() / "trajectory.tum");
  for (StampedPose& s : truth) s.pose.translation *= 3.0;
  write_tum(folder / "truth.tum", truth);
  const auto result =
      run_command({"report", session().string(), "--ground-truth", (folder / "truth.tum").string(),
                   "--out", (folder / "page.html").string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const std::string page = read_text(folder / "page.html");
  EXPECT_NE(page.find("not to be trusted"), std::string::npos);
  EXPECT_NE(page.find("off the ground truth"), std::string::npos);
}

TEST_F(SessionPages, CompareOfASessionWithItselfFindsNothing) {
  const auto result = run_command({"compare", session().string(), session().string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_NE(result.standard_output.find("position [m]"), std::string::npos)
      << result.standard_output;
  const std::size_t at = result.standard_output.find("position [m]");
  const std::string line =
      result.standard_output.substr(at, result.standard_output.find('\n', at) - at);
  EXPECT_EQ(line.find_first_of("123456789"), std::string::npos) << line;
  EXPECT_EQ(result.standard_output.find("few_inliers"), std::string::npos);
}

TEST_F(SessionPages, CompareNamesTheOptionsThatDiffer) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_command({"run", "sim:town?sensor=spin16&length=40&seed=3", "--out",
                         (folder / "other").string(), "--quiet", "--set", "closures.min_inliers=9"})
                .exit_code,
            0);
  const auto result = run_command({"compare", session().string(), (folder / "other").string(),
                                   "--out", (folder / "page.html").string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_NE(read_text(folder / "page.html").find("closures.min_inliers"), std::string::npos);
}

TEST_F(SessionPages, DoctorReadsSessionsAndRecordings) {
  const auto session_result = run_command({"doctor", session().string()});
  EXPECT_EQ(session_result.exit_code, 0) << session_result.standard_error;
  EXPECT_NE(session_result.standard_output.find("result"), std::string::npos);
  const auto recording = run_command({"doctor", "sim:town?sensor=spin16&length=40&seed=3"});
  EXPECT_EQ(recording.exit_code, 0) << recording.standard_error;
  EXPECT_NE(recording.standard_output.find("scans"), std::string::npos);
  const TemporaryFolder folder;
  expect_input_error(run_command({"doctor", (folder / "nowhere").string()}), {"nowhere"});
}

TEST_F(SessionPages, DoctorNamesADamagedFile) {
  const TemporaryFolder folder;
  fs::copy(session(), folder / "copy", fs::copy_options::recursive);
  std::ofstream(folder / "copy" / "trajectory.tum", std::ios::app) << "1 2 3\n";
  expect_input_error(run_command({"doctor", (folder / "copy").string()}), {"trajectory.tum"});
}

TEST_F(SessionPages, EvaluateAndOptimizeWriteTheirPages) {
  const TemporaryFolder folder;
  const std::string trajectory = (session() / "trajectory.tum").string();
  ASSERT_EQ(run_command({"evaluate", "trajectory", "--estimate", trajectory, "--ground-truth",
                         trajectory, "--report", (folder / "errors.html").string()})
                .exit_code,
            0);
  EXPECT_NE(read_text(folder / "errors.html").find("0.000 m"), std::string::npos);
  ASSERT_EQ(
      run_command({"optimize", (session() / "pose_graph.g2o").string(), "--out",
                   (folder / "out.g2o").string(), "--report", (folder / "graph.html").string()})
          .exit_code,
      0);
  EXPECT_NE(read_text(folder / "graph.html").find("cost"), std::string::npos);
}

}  // namespace
}  // namespace groundloop
