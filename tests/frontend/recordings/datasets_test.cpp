// Scans of published datasets, built byte by byte from the datasets' descriptions.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::Bytes;
using ::testing::HasSubstr;
using testing::write_file;

class Dataset : public ::testing::Test {
 protected:
  std::unique_ptr<Recording> open(const std::string& topic = "") {
    RecordingOptions options;
    options.topic = topic;
    return open_recording(folder_.path().string(), options);
  }
  std::string error_of_reading(const std::string& topic = "") {
    try {
      const auto recording = open(topic);
      for (std::size_t i = 0; i < recording->size(); ++i) (void)recording->read(i);
    } catch (const InputError& e) {
      EXPECT_THAT(std::string(e.what()), ::testing::Not(HasSubstr("\n")));
      return e.what();
    }
    return "none";
  }
  static void expect_pose(const Pose& pose, double x, double y, double z, double yaw_deg) {
    EXPECT_NEAR((pose.translation - Eigen::Vector3d(x, y, z)).norm(), 0.0, 1e-6);
    const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
    EXPECT_NEAR(std::atan2(ahead.y(), ahead.x()) * 180 / std::numbers::pi, yaw_deg, 1e-3);
  }
  testing::TemporaryFolder folder_;
};

using KittiRaw = Dataset;

TEST_F(KittiRaw, TakesTimesFromAzimuthAndTurnFromItsTwoStamps) {
  const fs::path velodyne = folder_ / "velodyne_points";
  // Just left of straight behind, left, ahead, right, just right of behind: clockwise from behind.
  write_file(
      velodyne / "data/0000000000.bin",
      Bytes().floats(-10, 1e-4, 0, 0, 0, 10, 0, 0, 10, 0, 0, 0, 0, -10, 0, 0, -10, -1e-4, 0, 0));
  write_file(velodyne / "timestamps.txt", "2011-09-26 13:02:25.050000000\n");
  write_file(velodyne / "timestamps_start.txt", "2011-09-26 13:02:25.000000001\n");
  write_file(velodyne / "timestamps_end.txt", "2011-09-26 13:02:25.100000001\n");
  const auto recording = open();
  EXPECT_EQ(recording->info().format, "kitti_raw");
  EXPECT_EQ(recording->stamp(0), 1'317'042'145'000'000'001);  // date -u -d ... +%s
  const Scan scan = recording->read(0);
  ASSERT_EQ(scan.times.size(), 5U);
  const double expected[] = {0.0, 0.025, 0.05, 0.075, 0.1};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(scan.times[i], expected[i], 1e-6);
}

TEST_F(KittiRaw, BringsGpsToTheLidar) {
  const fs::path drive = folder_ / "drive";
  write_file(drive / "velodyne_points/data/0000000000.bin", Bytes().floats(1, 2, 3, 0));
  write_file(drive / "velodyne_points/timestamps.txt", "2011-09-26 13:02:25.5\n");
  write_file(drive / "oxts/timestamps.txt", "2011-09-26 13:02:25.0\n2011-09-26 13:02:26.0\n");
  // A thousandth of a degree to the east at the equator, heading turned by 90 degrees.
  write_file(drive / "oxts/data/0000000000.txt", "0 8 100 0 0 0 1 2 3\n");
  write_file(drive / "oxts/data/0000000001.txt", "0 8.001 100 0 0 1.5707963267948966 1 2 3\n");
  // The IMU's origin in the LiDAR's frame is (-0.8, 0.3, -0.8).
  write_file(folder_ / "calib_imu_to_velo.txt",
             "calib_time: 25-May-2012 16:47:16\nR: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
  RecordingOptions options;
  const Trajectory truth = open_recording(drive.string(), options)->ground_truth();
  ASSERT_EQ(truth.size(), 2U);
  const double east = 6378137.0 * 0.001 * std::numbers::pi / 180.0;
  const Eigen::Vector3d step = truth[1].pose.translation - truth[0].pose.translation;
  // LiDAR ahead of the IMU by (0.8, -0.3): after the turn at (0.3, 0.8).
  EXPECT_NEAR(step.x(), east + 0.3 - 0.8, 1e-6);
  EXPECT_NEAR(step.y(), 0.8 + 0.3, 1e-6);
}

TEST_F(KittiRaw, NamesBadStamps) {
  const fs::path velodyne = folder_ / "velodyne_points";
  write_file(velodyne / "data/0000000000.bin", Bytes().floats(1, 2, 3, 0));
  write_file(velodyne / "timestamps.txt", "yesterday\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("timestamps.txt:1: 'yesterday' is no date"));
  write_file(velodyne / "timestamps.txt", "");
  EXPECT_THAT(error_of_reading(), HasSubstr("0 stamps for 1 scans"));
}

using Mulran = Dataset;

TEST_F(Mulran, TakesTimesFromTheColumnOfWholeScans) {
  Bytes scan;
  for (int column = 0; column < 1024; ++column) {
    for (int row = 0; row < 64; ++row) {
      // Only two columns have returns; the sensor writes zeros elsewhere.
      const bool hit = row == 5 && (column == 0 || column == 512);
      scan.floats(hit ? column + 1 : 0, hit ? 2 : 0, hit ? 3 : 0, 9);
    }
  }
  write_file(folder_ / "sensor_data/Ouster/1561000444390857630.bin", scan);
  write_file(folder_ / "global_pose.csv",
             "1561000444390857630,1,0,0,353000.5,0,1,0,4026000.25,0,0,1,20\n");
  const auto recording = open();
  EXPECT_EQ(recording->info().format, "mulran");
  EXPECT_EQ(recording->stamp(0), 1'561'000'444'390'857'630);
  const Scan read = recording->read(0);
  ASSERT_EQ(read.points.size(), 2U);
  EXPECT_EQ(read.points[1], Eigen::Vector3f(513, 2, 3));
  EXPECT_FLOAT_EQ(read.times[0], 0.0F);
  EXPECT_FLOAT_EQ(read.times[1], 0.05F);
  // The LiDAR looks backward, 1.7 m ahead of the vehicle's origin.
  const Trajectory truth = recording->ground_truth();
  EXPECT_EQ(truth[0].stamp, 1'561'000'444'390'857'630);
  expect_pose(truth[0].pose, 353000.5 + 1.7042, 4026000.25 - 0.021, 20 + 1.8047, 179.6654);
}

TEST_F(Mulran, ScansThatAreNotWholeHaveNoTimes) {
  write_file(folder_ / "Ouster/1561000444390857630.bin", Bytes().floats(1, 2, 3, 9, 0, 0, 0, 0));
  const Scan scan = open()->read(0);
  EXPECT_EQ(scan.points.size(), 1U);
  EXPECT_TRUE(scan.times.empty());
}

TEST_F(Mulran, NamesWhatIsWrong) {
  write_file(folder_ / "Ouster/1561000444390857630.bin", Bytes().floats(1, 2, 3));
  EXPECT_THAT(error_of_reading(), HasSubstr("12 bytes are no multiple of 16"));
  write_file(folder_ / "Ouster/1561000444390857630.bin", Bytes().floats(1, 2, 3, 4));
  write_file(folder_ / "global_pose.csv", "1561000444390857630,1,0,0,1,0,1,0,2,0,0,2,20\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("global_pose.csv:1: the left 3x3 block"));
  write_file(folder_ / "global_pose.csv", "1,2,3\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("expected 13"));
  write_file(folder_ / "Ouster/first.bin", Bytes().floats(1, 2, 3, 4));
  EXPECT_THAT(error_of_reading(), HasSubstr("first.bin: its name is no stamp in ns"));
}

using Helipr = Dataset;

void put_helipr(const fs::path& root, const std::string& sensor, const std::string& stamp) {
  Bytes scan;
  for (int i = 0; i < 2; ++i) {
    scan.floats(1 + i, 2, 3);
    if (sensor == "Ouster") {
      scan.floats(7)
          .put(std::uint32_t{90'000'000U * i})
          .put<std::uint16_t>(1)
          .put<std::uint16_t>(2);
      scan.put<std::uint16_t>(3);
    } else if (sensor == "Velodyne") {
      scan.floats(7).put<std::uint16_t>(5).floats(0.09 * i);
    } else if (sensor == "Avia") {
      scan.put<std::uint8_t>(1).put<std::uint8_t>(2).put<std::uint8_t>(3);
      scan.put(std::uint32_t{90'000'000U * i});
    } else {
      scan.floats(7, -1.5).put(std::int32_t{90'000'000 * i}).put<std::uint8_t>(4);
      if (stamp > "1691936557946849179") scan.floats(8);
    }
  }
  write_file(root / "LiDAR" / sensor / (stamp + ".bin"), scan);
}

TEST_F(Helipr, ReadsTheRecordOfEachSensor) {
  for (const auto& [sensor, stamp] :
       {std::pair<std::string, std::string>{"Ouster", "1691936556946849179"},
        {"Velodyne", "1691936556946849179"},
        {"Avia", "1691936556946849179"},
        {"Aeva", "1691936557946849179"},
        {"Aeva", "1691936557946849180"}}) {
    testing::TemporaryFolder root;
    put_helipr(root.path(), sensor, stamp);
    write_file(root / "LiDAR_GT" / (sensor + "_gt.txt"), stamp + " 1 2 3 0 0 1 0\n");
    for (const fs::path& path : {root.path(), root / "LiDAR", root / "LiDAR" / sensor}) {
      const auto recording = open_recording(path.string());
      EXPECT_EQ(recording->info().format, "helipr") << path;
      EXPECT_EQ(recording->info().sensor, sensor);
      const Scan scan = recording->read(0);
      ASSERT_EQ(scan.points.size(), 2U) << sensor;
      EXPECT_EQ(scan.points[1], Eigen::Vector3f(2, 2, 3));
      EXPECT_NEAR(scan.times[0], 0.0, 1e-9);
      EXPECT_NEAR(scan.times[1], 0.09, 1e-8) << sensor;
      const Trajectory truth = recording->ground_truth();
      ASSERT_EQ(truth.size(), 1U);
      EXPECT_EQ(truth[0].stamp, recording->stamp(0));
      EXPECT_NEAR(std::abs(truth[0].pose.rotation.z()), 1.0, 1e-12);
    }
  }
}

TEST_F(Helipr, AsksForOneOfSeveralSensors) {
  put_helipr(folder_.path(), "Ouster", "1691936556946849179");
  put_helipr(folder_.path(), "Avia", "1691936556946849179");
  EXPECT_THAT(error_of_reading(), HasSubstr("Ouster (1 scans), Avia (1 scans)"));
  EXPECT_EQ(open("Avia")->info().sensor, "Avia");
  EXPECT_THAT(error_of_reading("Aeva"), HasSubstr("no sensor 'Aeva'"));
}

TEST_F(Helipr, NamesWrongRecordSize) {
  write_file(folder_ / "LiDAR/Avia/1691936556946849179.bin", Bytes().floats(1, 2, 3, 4, 5));
  EXPECT_THAT(error_of_reading(), HasSubstr("20 bytes are no multiple of 19"));
}

using Nclt = Dataset;

// Unsigned 16-bit in steps of 5 mm from -100 m.
std::uint16_t packed(double metres) {
  return static_cast<std::uint16_t>(std::lround((metres + 100.0) / 0.005));
}
void put_hit(Bytes& bytes, double x, double y, double z) {
  bytes.put(packed(x)).put(packed(y)).put(packed(z)).put<std::uint8_t>(7).put<std::uint8_t>(3);
}

TEST_F(Nclt, ReadsVelodyneSyncTurnedUpright) {
  Bytes scan;
  put_hit(scan, 10, 2, 1.5);  // x forward, y right, z down
  put_hit(scan, -60.005, -0.5, -3);
  write_file(folder_ / "velodyne_sync/1326030975726043.bin", scan);
  // A metre north (x), two east (y), three below; heading 90 degrees to the east.
  write_file(folder_ / "groundtruth_2012-01-08.csv",
             "1326030975000000,nan,nan,nan,nan,nan,nan\n1326030975726043,1,2,3,0,0,1.570796327\n");
  const auto recording = open();
  EXPECT_EQ(recording->info().format, "nclt");
  EXPECT_EQ(recording->stamp(0), 1'326'030'975'726'043'000);
  const Scan read = recording->read(0);
  ASSERT_EQ(read.points.size(), 2U);
  EXPECT_LT((read.points[0] - Eigen::Vector3f(10, -2, -1.5F)).norm(), 1e-4);
  EXPECT_LT((read.points[1] - Eigen::Vector3f(-60.005F, 0.5F, 3)).norm(), 1e-4);
  const Trajectory truth = recording->ground_truth();
  ASSERT_EQ(truth.size(), 1U);
  // With z upward, y is left and the heading counts the other way.
  expect_pose(truth[0].pose, 1, -2, -3, -90);
}

void put_packet(Bytes& file, std::int64_t utime, double azimuth_deg) {
  for (int i = 0; i < 4; ++i) file.put<std::uint16_t>(44444);
  file.put<std::uint32_t>(2).put(utime).put<std::uint32_t>(0);
  const double a = azimuth_deg * std::numbers::pi / 180;
  put_hit(file, 10 * std::cos(a), 10 * std::sin(a), 1);
  put_hit(file, 20 * std::cos(a), 20 * std::sin(a), 2);
}

TEST_F(Nclt, CutsVelodyneHitsIntoTurns) {
  Bytes file;
  for (int i = 0; i < 25; ++i) put_packet(file, 1'326'030'975'000'000 + 10'000 * i, 36.0 * i);
  write_file(folder_ / "velodyne_hits.bin", file.str() + "cut off");
  const auto recording = open();
  ASSERT_EQ(recording->size(), 3U);  // two whole turns of ten packets and a half
  EXPECT_EQ(recording->stamp(1), 1'326'030'975'100'000'000);
  const Scan scan = recording->read(1);
  ASSERT_EQ(scan.points.size(), 20U);
  EXPECT_NEAR(scan.times[0], 0.0, 1e-7);
  EXPECT_NEAR(scan.times[2], 0.01, 1e-7);
  EXPECT_NEAR(scan.times[3], 0.015, 1e-7);  // half way to the next packet
  EXPECT_THAT(recording->info().warnings.back(), HasSubstr("cut off"));
}

TEST_F(Nclt, NamesWhatIsNoPacket) {
  Bytes file;
  put_packet(file, 1'326'030'975'000'000, 0);
  write_file(folder_ / "velodyne_hits.bin", file.str() + std::string(64, 'x'));
  EXPECT_THAT(error_of_reading(), HasSubstr("byte 40: no packet of NCLT begins here"));
  write_file(folder_ / "velodyne_hits.bin", "");
  EXPECT_THAT(error_of_reading(), HasSubstr("holds no packet"));
}

}  // namespace
}  // namespace groundloop
