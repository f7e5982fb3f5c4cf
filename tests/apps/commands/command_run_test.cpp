// Bad input to `groundloop run`: one line that names file, place and remedy, exit code 2, nothing
// left behind.
#include <cmath>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>

#include "frontend/core/files.hpp"
#include "frontend/core/trajectory.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::CommandResult;
using testing::expect_input_error;
using testing::run_command;
using testing::TemporaryFolder;

// A KITTI recording of four scans of a corridor, written byte by byte.
class KittiFolder {
 public:
  explicit KittiFolder(const fs::path& root) : root_(root) {
    fs::create_directories(velodyne());
    fs::create_directories(root_ / "poses");
    for (int i = 0; i < 4; ++i) write_scan(i, corridor(0.5F * static_cast<float>(i)));
    write(sequence() / "times.txt", "0.0\n0.1\n0.2\n0.3\n");
    write(sequence() / "calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    write(root_ / "poses" / "00.txt", pose_lines(4));
  }
  [[nodiscard]] fs::path sequence() const { return root_ / "sequences" / "00"; }
  [[nodiscard]] fs::path velodyne() const { return sequence() / "velodyne"; }
  [[nodiscard]] fs::path scan(int i) const {
    return velodyne() / ("00000" + std::to_string(i) + ".bin");
  }

  static void write(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }
  void write_scan(int i, const std::vector<float>& values) const {
    std::ofstream(scan(i), std::ios::binary)
        .write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(float)));
  }
  static std::string pose_lines(int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += "1 0 0 " + std::to_string(0.5 * i) + " 0 1 0 0 0 0 1 0\n";
    return text;
  }
  static std::vector<float> corridor(float offset) {
    std::vector<float> values;
    for (int i = -20; i < 20; ++i) {
      for (int k = 0; k < 5; ++k) {
        for (const float side : {-5.0F, 5.0F}) {
          values.insert(values.end(),
                        {static_cast<float>(i) - offset, side, static_cast<float>(k), 0.5F});
        }
      }
    }
    return values;
  }

 private:
  fs::path root_;
};

struct Fault {
  const char* name;
  std::function<void(const KittiFolder&)> make;
  std::vector<std::string> arguments;
  std::vector<std::string> expected;
};

class RunWithFault : public ::testing::TestWithParam<Fault> {};

TEST_P(RunWithFault, EndsWithOneLineAndLeavesNothing) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  GetParam().make(kitti);
  std::vector<std::string> arguments{"run", (folder / "recording").string(), "--out",
                                     (folder / "out").string()};
  arguments.insert(arguments.end(), GetParam().arguments.begin(), GetParam().arguments.end());
  expect_input_error(run_command(arguments), GetParam().expected);
  EXPECT_FALSE(fs::exists(folder / "out"));
}

const std::function<void(const KittiFolder&)> kNothing = [](const KittiFolder&) {};

INSTANTIATE_TEST_SUITE_P(
    Faults, RunWithFault,
    ::testing::Values(
        Fault{"MissingScans",
              [](const KittiFolder& k) { fs::remove_all(k.velodyne()); },
              {},
              {"recording"}},
        Fault{"EmptyFolder",
              [](const KittiFolder& k) {
                for (int i = 0; i < 4; ++i) fs::remove(k.scan(i));
              },
              {},
              {"velodyne"}},
        Fault{"NoScanThatCanBeUsed",
              [](const KittiFolder& k) {
                for (int i = 0; i < 4; ++i) k.write_scan(i, std::vector<float>(400, NAN));
              },
              {},
              {"000000.bin", "NaN"}},
        Fault{"TooFewPointsInEveryScan",
              [](const KittiFolder& k) {
                for (int i = 0; i < 4; ++i) k.write_scan(i, {1, 2, 3, 0, 4, 5, 6, 0});
              },
              {},
              {"points"}},
        Fault{"FewerStampsThanScans",
              [](const KittiFolder& k) {
                KittiFolder::write(k.sequence() / "times.txt", "0.0\n0.1\n");
              },
              {},
              {"times.txt", "2"}},
        Fault{"StampIsNoNumber",
              [](const KittiFolder& k) {
                KittiFolder::write(k.sequence() / "times.txt", "0.0\n0.1\nnan\n0.3\n");
              },
              {},
              {"times.txt:3"}},
        Fault{"GroundTruthOfAnotherLength",
              [](const KittiFolder& k) {
                KittiFolder::write(k.sequence().parent_path().parent_path() / "poses" / "00.txt",
                                   KittiFolder::pose_lines(3));
              },
              {},
              {"00.txt", "3"}},
        Fault{"GroundTruthIsNoRotation",
              [](const KittiFolder& k) {
                KittiFolder::write(k.sequence().parent_path().parent_path() / "poses" / "00.txt",
                                   KittiFolder::pose_lines(3) + "2 0 0 0 0 1 0 0 0 0 1 0\n");
              },
              {},
              {"00.txt:4", "rotation"}},
        Fault{"UnknownKey",
              kNothing,
              {"--set", "odometry.voxel_sise=1"},
              {"voxel_sise", "odometry.voxel_size"}},
        Fault{"ValueOutOfRange",
              kNothing,
              {"--set", "odometry.voxel_size=-1"},
              {"odometry.voxel_size", "-1", "0.05"}},
        Fault{"ValueIsNoNumber",
              kNothing,
              {"--set", "odometry.voxel_size=big"},
              {"odometry.voxel_size", "big"}},
        Fault{"MissingConfiguration",
              kNothing,
              {"--config", "/nonexistent.yaml"},
              {"/nonexistent.yaml"}},
        Fault{"NegativeCount", kNothing, {"--count", "-5"}, {"--count", "-5"}},
        Fault{"NegativeFirst", kNothing, {"--first", "-1"}, {"--first", "-1"}},
        Fault{"UnknownFormat", kNothing, {"--format", "kity"}, {"kity"}},
        Fault{"ResumeWithoutAnInterruptedRun", kNothing, {"--resume"}, {"no interrupted session"}}),
    [](const auto& fault) { return std::string(fault.param.name); });

// A scan that cannot be used is bridged, named and counted, wherever it stands.
TEST(Run, ScansThatCannotBeUsedEndNothingAndAreNamed) {
  const std::vector<std::function<void(const KittiFolder&, int)>> faults{
      [](const KittiFolder& k, int i) { fs::resize_file(k.scan(i), 1001); },
      [](const KittiFolder& k, int i) { k.write_scan(i, {}); },
      [](const KittiFolder& k, int i) { k.write_scan(i, std::vector<float>(400, NAN)); }};
  for (const int scan : {0, 2}) {
    for (const auto& fault : faults) {
      const TemporaryFolder folder;
      const KittiFolder kitti(folder / "recording");
      fault(kitti, scan);
      const CommandResult result =
          run_command({"run", (folder / "recording").string(), "--out", (folder / "out").string()});
      EXPECT_EQ(result.exit_code, 0) << result.standard_error;
      const std::string name = kitti.scan(scan).filename().string();
      EXPECT_THAT(result.standard_error, ::testing::HasSubstr(name));
      EXPECT_EQ(read_tum(folder / "out/trajectory.tum").size(), 4U);
      EXPECT_THAT(read_text(folder / "out/metrics.json"),
                  ::testing::HasSubstr("\"unusable_scans\": 1"));
    }
  }
}

TEST(Run, AScanOfTwoPointsEndsNothingAndIsSaid) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  kitti.write_scan(3, {1, 2, 3, 0, 4, 5, 6, 0});
  const CommandResult result =
      run_command({"run", (folder / "recording").string(), "--out", (folder / "out").string()});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error, ::testing::HasSubstr("scan 3: only 2 points"));
  EXPECT_EQ(read_tum(folder / "out/trajectory.tum").size(), 4U);
}

TEST(Run, MissingRecordingIsNamed) {
  const TemporaryFolder folder;
  expect_input_error(
      run_command({"run", "/nonexistent/recording", "--out", (folder / "out").string()}),
      {"/nonexistent/recording"});
}

TEST(Run, OutputThatCannotBeWrittenIsNamed) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  expect_input_error(
      run_command({"run", (folder / "recording").string(), "--out", "/proc/nowhere/out"}),
      {"/proc/nowhere/out", "--out"});
}

TEST(Run, GroundTruthIsTestedBeforeTheWorkBegins) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  const auto run_with = [&](const std::string& name, const std::string& text) {
    KittiFolder::write(folder / name, text);
    return run_command({"run", (folder / "recording").string(), "--out", (folder / "out").string(),
                        "--ground-truth", (folder / name).string()});
  };
  expect_input_error(run_with("late.tum", "900 0 0 0 0 0 0 1\n901 1 0 0 0 0 0 1\n"),
                     {"late.tum", "no pose lies at a scan's stamp", "900.0"});
  expect_input_error(run_with("rows.txt", KittiFolder::pose_lines(3)), {"rows.txt", "3 poses"});
  expect_input_error(run_with("columns.txt", "1 2 3\n"), {"columns.txt", "3 columns"});
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Run, RowsOfTheWholeRecordingServeAPartOfIt) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  KittiFolder::write(folder / "truth.txt", KittiFolder::pose_lines(4));
  const auto result = run_command({"run", (folder / "recording").string(), "--out",
                                   (folder / "out").string(), "--first", "1", "--count", "2",
                                   "--ground-truth", (folder / "truth.txt").string()});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_NE(result.standard_error.find("APE"), std::string::npos) << result.standard_error;
}

TEST(Run, RefusesAFolderOfOtherFiles) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  fs::create_directories(folder / "thesis");
  KittiFolder::write(folder / "thesis" / "final.tex", "years");
  expect_input_error(
      run_command({"run", (folder / "recording").string(), "--out", (folder / "thesis").string()}),
      {"thesis", "--out"});
  EXPECT_TRUE(fs::exists(folder / "thesis" / "final.tex"));
}

TEST(Run, WhatIsRefusedIsNamedWithTheNearestThatExists) {
  expect_input_error(run_command({"frobnicate"}), {"'frobnicate'", "merge", "inspect"});
  expect_input_error(run_command({"merg", "a", "b"}), {"'merg'", "did you mean 'merge'?"});
  expect_input_error(run_command({"evaluate", "trajectoy"}), {"did you mean 'trajectory'?"});
  expect_input_error(run_command({"run", "x", "--ouut", "y"}),
                     {"'--ouut'", "did you mean '--out'?", "groundloop run --help"});
  expect_input_error(run_command({"run", "x", "--out", "y", "--treads", "2"}),
                     {"did you mean '--threads'?"});
  expect_input_error(run_command({"config", "default", "more"}), {"'more'"});
}

TEST(Run, UnknownSubcommandAndMissingOptionsAreUsageErrors) {
  EXPECT_EQ(run_command({"rum"}).exit_code, 2);
  EXPECT_EQ(run_command({}).exit_code, 2);
  EXPECT_EQ(run_command({"run"}).exit_code, 2);
  EXPECT_EQ(run_command({"--version"}).exit_code, 0);
}

TEST(Run, StampsThatStandStillOrGoBackAreSurvivedOrNamed) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  KittiFolder::write(kitti.sequence() / "times.txt", "0.0\n0.1\n0.1\n0.05\n");
  const auto result =
      run_command({"run", (folder / "recording").string(), "--out", (folder / "out").string()});
  EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 2) << result.standard_error;
  EXPECT_NE(result.standard_error.find("stamp"), std::string::npos) << result.standard_error;
}

TEST(Run, LeavesTheWholeSession) {
  const TemporaryFolder folder;
  const KittiFolder kitti(folder / "recording");
  const auto result =
      run_command({"run", (folder / "recording").string(), "--out", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  for (const char* name : {"config.yaml", "manifest.json", "odometry.tum", "trajectory.tum",
                           "trajectory.kitti", "closures.csv", "pose_graph.g2o", "local_maps.csv",
                           "local_maps/000000.pcd", "scans/000000.bin", "loop_database.bin",
                           "map.pcd", "metrics.json", "report.html", "run.log"}) {
    EXPECT_TRUE(fs::exists(folder / "out" / name)) << name;
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder / "out")) {
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
  }
}

TEST(Report, OfWhatIsNoSessionNamesTheFileAndTheRemedy) {
  const TemporaryFolder folder;
  testing::expect_input_error(run_command({"report", folder.path().string()}), {"manifest.json"});
}

TEST(Config, PrintsWhatItReadsBack) {
  const TemporaryFolder folder;
  const auto printed = run_command({"config"});
  ASSERT_EQ(printed.exit_code, 0);
  KittiFolder::write(folder / "all.yaml", printed.standard_output);
  const auto again = run_command({"config", (folder / "all.yaml").string()});
  EXPECT_EQ(again.standard_output, printed.standard_output);
  EXPECT_NE(printed.standard_output.find("odometry:\n  max_range: 100"), std::string::npos);
}

}  // namespace
}  // namespace groundloop
