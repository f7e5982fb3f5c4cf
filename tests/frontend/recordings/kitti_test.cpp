// The KITTI layout, built here byte by byte as the benchmark's page describes it.
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/unreadable_file.hpp"
#include "frontend/recordings/elevation_correction.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void write_floats(const fs::path& file, const std::vector<float>& values) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(float)));
}

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

// Two scans of two points; camera looks along the LiDAR's x axis: x_cam = -y, y_cam = -z, z_cam =
// x.
class Kitti : public ::testing::Test {
 protected:
  void SetUp() override {
    write_floats(sequence_ / "velodyne/000000.bin", {1, 2, 3, 0.5F, 4, 5, 6, 0.25F});
    write_floats(sequence_ / "velodyne/000001.bin", {7, 8, 9, 0.5F, 10, 11, 12, 1});
    write(sequence_ / "times.txt", "0.000000e+00\n1.036224e-01\n");
    write(sequence_ / "calib.txt",
          "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n");
    // The camera moves 2 m along its own z, the LiDAR's x.
    write(folder_ / "poses/03.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  }
  std::string error_of_reading() {
    try {
      const auto recording = open_recording(folder_.path().string());
      for (std::size_t i = 0; i < recording->size(); ++i) (void)recording->read(i);
    } catch (const InputError& e) {
      EXPECT_THAT(std::string(e.what()), ::testing::Not(HasSubstr("\n")));
      return e.what();
    }
    return "none";
  }

  testing::TemporaryFolder folder_;
  fs::path sequence_ = folder_ / "sequences/03";
};

TEST_F(Kitti, OpensByRootSequencesFolderAndSequence) {
  for (const fs::path& path : {folder_.path(), folder_ / "sequences", sequence_, sequence_ / ""}) {
    const auto recording = open_recording(path.string());
    EXPECT_EQ(recording->info().format, "kitti");
    EXPECT_EQ(recording->size(), 2U);
    EXPECT_EQ(recording->ground_truth().size(), 2U) << path;
  }
}

TEST_F(Kitti, ReadsPointsAndStamps) {
  const auto recording = open_recording(folder_.path().string());
  EXPECT_EQ(recording->stamp(1), 103'622'400);
  const Scan scan = recording->read(1);
  EXPECT_EQ(scan.stamp, 103'622'400);
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_EQ(scan.points[0], Eigen::Vector3f(7, 8, 9));
  EXPECT_EQ(scan.points[1], Eigen::Vector3f(10, 11, 12));
  EXPECT_TRUE(scan.times.empty());
}

TEST_F(Kitti, BringsGroundTruthToTheLidarFrame) {
  const Trajectory truth = open_recording(folder_.path().string())->ground_truth();
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_NEAR((truth[1].pose.translation - Eigen::Vector3d(2, 0, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(rotation_angle(truth[1].pose.rotation), 0.0, 1e-12);
  EXPECT_EQ(truth[1].stamp, 103'622'400);
}

TEST_F(Kitti, DropsInvalidPointsWithTheirTimes) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  write_floats(sequence_ / "velodyne/000000.bin",
               {1, 0, 0, 0, nan, 0, 0, 0, 0, 0, 0, 0, 0, inf, 0, 0, 2, 0, 0, 0});
  write_floats(sequence_ / "times_per_point/000000.bin", {0, 0.25F, 0.5F, 0.75F, 1});
  write_floats(sequence_ / "times_per_point/000001.bin", {0, 1});
  const auto recording = open_recording(folder_.path().string());
  const Scan scan = recording->read(0);
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_EQ(scan.points[1], Eigen::Vector3f(2, 0, 0));
  ASSERT_EQ(scan.times.size(), 2U);
  EXPECT_EQ(scan.times[0], 0.0F);
  EXPECT_NEAR(scan.times[1], 0.1036224, 1e-7);  // the whole period between the two scans
}

TEST_F(Kitti, SlicesScansStampsAndGroundTruth) {
  RecordingOptions options;
  options.first = 1;
  options.count = 5;
  const auto recording = open_recording(folder_.path().string(), options);
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_EQ(recording->stamp(0), 103'622'400);
  EXPECT_EQ(recording->read(0).points[0], Eigen::Vector3f(7, 8, 9));
  EXPECT_EQ(recording->ground_truth().size(), 1U);
  options.first = 2;
  EXPECT_THROW((void)open_recording(folder_.path().string(), options), InputError);
}

TEST_F(Kitti, FindsStampsByFileNumberWhereOnlySomeScansAreThere) {
  fs::remove(sequence_ / "velodyne/000000.bin");
  const auto recording = open_recording(folder_.path().string());
  ASSERT_EQ(recording->size(), 1U);
  EXPECT_EQ(recording->stamp(0), 103'622'400);
  EXPECT_NEAR(recording->ground_truth()[0].pose.translation.x(), 2.0, 1e-12);
}

TEST_F(Kitti, AsksWhichOfSeveralSequences) {
  write_floats(folder_ / "sequences/04/velodyne/000000.bin", {1, 2, 3, 0});
  EXPECT_THAT(error_of_reading(), HasSubstr("03, 04"));
}

TEST_F(Kitti, NamesCutOffScan) {
  fs::resize_file(sequence_ / "velodyne/000001.bin", 30);
  EXPECT_THAT(error_of_reading(), HasSubstr("000001.bin: 30 bytes are no multiple of 16"));
}

TEST_F(Kitti, RefusesACutOffScanWhenTheRecordingOpens) {
  fs::resize_file(sequence_ / "velodyne/000001.bin", 30);
  EXPECT_THROW((void)open_recording(folder_.path().string()), InputError);
}

// A scan that cannot be used is bridged by who reads; a file that is not handed out ends a run.
TEST_F(Kitti, AFileThatIsGoneIsNoBrokenScan) {
  const auto recording = open_recording(folder_.path().string());
  fs::remove(sequence_ / "velodyne/000001.bin");
  EXPECT_THROW((void)recording->read(1), UnreadableFile);
}

TEST_F(Kitti, NamesEmptyScan) {
  fs::resize_file(sequence_ / "velodyne/000001.bin", 0);
  EXPECT_THAT(error_of_reading(), HasSubstr("000001.bin: holds no point"));
}

TEST_F(Kitti, NamesScanOfNans) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  write_floats(sequence_ / "velodyne/000000.bin", {nan, 0, 0, 0, nan, nan, nan, 0});
  EXPECT_THAT(error_of_reading(), HasSubstr("000000.bin: none of its 2 points is valid"));
}

TEST_F(Kitti, NamesFolderWithoutScans) {
  fs::remove(sequence_ / "velodyne/000000.bin");
  fs::remove(sequence_ / "velodyne/000001.bin");
  EXPECT_THAT(error_of_reading(), HasSubstr("holds no scan"));
}

TEST_F(Kitti, NamesFewerStampsThanScans) {
  write(sequence_ / "times.txt", "0.5\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("1 stamps for 2 scans"));
}

TEST_F(Kitti, NamesStampThatStandsStillOrGoesBack) {
  write(sequence_ / "times.txt", "0.5\n0.5\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("times.txt:2: stamp 0.500000000 stands still"));
  write(sequence_ / "times.txt", "0.5\n0.4\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("times.txt:2: stamp 0.400000000 goes back"));
}

TEST_F(Kitti, NamesStampThatIsNaN) {
  write(sequence_ / "times.txt", "0.5\nnan\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("times.txt:2: 'nan' is no stamp"));
}

TEST_F(Kitti, NamesGroundTruthOfOtherLength) {
  write(folder_ / "poses/03.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("1 poses for 2 scans"));
}

TEST_F(Kitti, NamesMatrixThatIsNoRotation) {
  write(folder_ / "poses/03.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 2 0 0 0 0 1 0\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("03.txt:2: the left 3x3 block is no rotation"));
  write(folder_ / "poses/03.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  write(sequence_ / "calib.txt", "Tr: 0 -1 0 0.1 0 0 1 0.2 1 0 0 0.3\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("calib.txt:1: the left 3x3 block is no rotation"));
}

TEST_F(Kitti, NamesCalibrationWithoutTr) {
  write(sequence_ / "calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("no line 'Tr:'"));
}

TEST_F(Kitti, NamesTimesOfOtherLengthOrRange) {
  write_floats(sequence_ / "times_per_point/000000.bin", {0, 1});
  write_floats(sequence_ / "times_per_point/000001.bin", {0});
  EXPECT_THAT(error_of_reading(), HasSubstr("4 bytes for a scan of 2 points"));
  write_floats(sequence_ / "times_per_point/000001.bin", {0, 5});
  EXPECT_THAT(error_of_reading(), HasSubstr("time 5 of point 1 is outside [0, 1]"));
}

TEST_F(Kitti, RefusesUnknownFormatAndCorrection) {
  RecordingOptions options;
  options.format = "kity";
  EXPECT_THROW((void)open_recording(folder_.path().string(), options), InputError);
  options.format = "kitti";
  options.elevation_correction = "maybe";
  EXPECT_THROW((void)open_recording(folder_.path().string(), options), InputError);
}

TEST(OpenRecording, NamesMissingAndUnknownPaths) {
  testing::TemporaryFolder folder;
  EXPECT_THROW((void)open_recording((folder / "absent").string()), InputError);
  EXPECT_THROW((void)open_recording(folder.path().string()), InputError);
}

TEST(ElevationCorrection, RaisesElevationAndKeepsRangeAndAzimuth) {
  Points points = {{10, 5, -2}, {-3, 0.5F, 1}, {0, -8, 0}};
  const Points before = points;
  recordings::correct_elevation(points, 0.205);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d a = before[i].cast<double>(), b = points[i].cast<double>();
    EXPECT_NEAR(b.norm(), a.norm(), 1e-5);
    EXPECT_NEAR(std::atan2(b.y(), b.x()), std::atan2(a.y(), a.x()), 1e-6);
    const double raised = std::asin(b.z() / b.norm()) - std::asin(a.z() / a.norm());
    EXPECT_NEAR(raised * 180.0 / std::numbers::pi, 0.205, 1e-4);
  }
}

// Scans of `beams` beams between two elevations, over ground 1.7 m below and walls.
void write_spinning_scans(const fs::path& sequence, int beams, double top, double bottom) {
  std::mt19937 generator(7);
  for (int s = 0; s < 3; ++s) {
    std::vector<float> values;
    for (int b = 0; b < beams; ++b) {
      const double e = (top + (bottom - top) * b / (beams - 1)) * std::numbers::pi / 180.0;
      for (int a = 0; a < 200; ++a) {
        const double azimuth = 2 * std::numbers::pi * a / 200;
        const double wall = 8.0 + 0.2 * static_cast<double>(generator() % 200);
        const double r = e < 0 ? std::min(wall, 1.7 / std::sin(-e)) : wall;
        for (const double v : {r * std::cos(e) * std::cos(azimuth),
                               r * std::cos(e) * std::sin(azimuth), r * std::sin(e), 0.0}) {
          values.push_back(static_cast<float>(v));
        }
      }
    }
    write_floats(sequence / ("velodyne/00000" + std::to_string(s) + ".bin"), values);
  }
}

// The layout and the field of view say so, however sharp the beams are.
TEST(ElevationCorrection, IsAppliedToScansOfKittisSensorInItsLayout) {
  testing::TemporaryFolder folder;
  write_spinning_scans(folder.path(), 64, 2.0, -24.8);
  EXPECT_THAT(open_recording(folder.path().string())->info().notes.back(), HasSubstr("0.205"));
  RecordingOptions options;
  options.elevation_correction = "off";
  EXPECT_THAT(open_recording(folder.path().string(), options)->info().notes.back(),
              HasSubstr("not corrected"));
}

TEST(ElevationCorrection, IsLeftOutForOtherSensors) {
  testing::TemporaryFolder folder;
  for (const auto& [beams, top, bottom] : {std::tuple{16, 15.0, -15.0}, {64, 22.5, -22.5}}) {
    write_spinning_scans(folder.path(), beams, top, bottom);
    const auto recording = open_recording(folder.path().string());
    EXPECT_THAT(recording->info().notes.back(), HasSubstr("not corrected")) << beams << " " << top;
  }
}

}  // namespace
}  // namespace groundloop
