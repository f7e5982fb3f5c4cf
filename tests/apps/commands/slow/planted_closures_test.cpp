// False closures planted in whole runs leave the trajectory what it was.
#include <gtest/gtest.h>

#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/session/session.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/command.hpp"
#include "tests/support/real_drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::run_command;
using testing::TemporaryFolder;

bool is_planted(const ClosureRecord& c) {
  return c.source == ClosureSource::detector && c.matches == 0;
}

// Runs `recording` as it is and with false closures: random ones, a group that agrees, near ones.
void compare(const std::string& recording) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& name, const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {
        "run", recording, "--out", (folder / name).string(), "--set", "map.write=false"};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    const auto result = run_command(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  };
  run("clean", {});
  const Trajectory clean = read_tum(folder / "clean" / "trajectory.tum");
  int accepted = 0;
  for (const ClosureRecord& c : read_closures(folder / "clean" / "closures.csv"))
    accepted += c.status == ClosureStatus::accepted ? 1 : 0;
  ASSERT_GT(accepted, 0);
  run("planted", {"--set", "planted_closures.random=8", "--set", "planted_closures.groups=1",
                  "--set", "planted_closures.near=3"});
  int planted = 0;
  for (const ClosureRecord& c : read_closures(folder / "planted" / "closures.csv")) {
    if (!is_planted(c)) continue;
    ++planted;
    EXPECT_NE(c.status, ClosureStatus::accepted) << c.reference_map << " - " << c.query_map;
  }
  EXPECT_GE(planted, 8 + 3);
  const TrajectoryEvaluation e =
      evaluate_trajectory(read_tum(folder / "planted" / "trajectory.tum"), clean);
  EXPECT_LT(e.ape.translation_m.rmse, 0.1);
}

TEST(PlantedClosures, LeaveATownWhatItWas) { compare("sim:town?sensor=spin16&length=1000&seed=3"); }

TEST(PlantedClosures, LeaveTheRealDriveWhatItWas) {
  const std::filesystem::path drive = testing::real_drive();
  if (drive.empty())
    GTEST_SKIP() << "the real drive (kitti_00_keyframes) is not beside the project";
  compare(drive.string());
}

}  // namespace
}  // namespace groundloop
