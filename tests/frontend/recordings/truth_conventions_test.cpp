// Ground truth by the conventions of data sets, from small fixtures after the published
// descriptions: the file is found, and its poses are of the LiDAR.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bag_bytes.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;

class TruthConventions : public ::testing::Test {
 protected:
  void write_scan(const std::string& name) {
    write_file(folder_ / name, Bytes().floats(1, 2, 3, 4));
  }
  void write_bag(const std::string& name) {
    write_file(folder_ / name, make_bag({{10, ros1_cloud(cloud_at(10, 0))}}, "none", true));
  }
  std::unique_ptr<Recording> open(const std::string& name) {
    return open_recording((folder_ / name).string());
  }
  // A pose at rest: what stands in the file is the identity, and what is read T_tracked_lidar.
  static void expect_pose(const Recording& recording, const Eigen::Vector3d& position,
                          const Eigen::Matrix3d& rotation, const std::string& note) {
    ASSERT_EQ(recording.ground_truth().size(), 1U);
    const Pose pose = recording.ground_truth()[0].pose;
    EXPECT_LT((pose.translation - position).norm(), 1e-9) << pose.translation.transpose();
    EXPECT_LT((pose.rotation.toRotationMatrix() - rotation).norm(), 1e-9);
    EXPECT_THAT(recording.info().notes, Contains(HasSubstr(note)));
  }
  static Eigen::Matrix3d about_z(double degrees) {
    return Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  TemporaryFolder folder_;
};

TEST_F(TruthConventions, NewerCollegeStereo) {
  write_file(folder_ / "01/raw_format/ouster_scan/cloud_1583836591_182590976.pcd",
             "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
             "POINTS 1\nDATA ascii\n1 2 3\n");
  write_file(folder_ / "01/ground_truth/registered_poses.csv",
             "#sec,nsec,x,y,z,qx,qy,qz,qw\n1583836591,182590976,0,0,0,0,0,0,1\n");
  for (const char* path : {"01", "01/raw_format/ouster_scan"}) {
    const auto recording = open(path);
    EXPECT_EQ(recording->stamp(0), 1'583'836'591'182'590'976);
    expect_pose(*recording, {-0.084, -0.025, 0.050}, about_z(135.0),
                "registered_poses.csv, by the convention of Newer College (stereo)");
    EXPECT_EQ(recording->ground_truth()[0].stamp, recording->stamp(0));
  }
}

TEST_F(TruthConventions, NewerCollegeMultiCamera) {
  write_bag("quad/2021-07-01-10-37-38-quad-easy.bag");
  write_file(folder_ / "quad/gt-nc-quad-easy.csv",
             "#sec,nsec,x,y,z,qx,qy,qz,qw\n10,0,1,2,3,0,0,0,1\n");
  for (const char* path : {"quad", "quad/2021-07-01-10-37-38-quad-easy.bag"}) {
    expect_pose(*open(path), {1.001, 2.0, 3.091}, about_z(0.0),
                "gt-nc-quad-easy.csv, by the convention of Newer College (multi-camera)");
  }
}

// Each bag of the folder has its own; the IMU lies upside down below the LiDAR.
TEST_F(TruthConventions, Hilti2022) {
  write_bag("h/exp04_construction_upper_level.bag");
  write_bag("h/exp14_basement_2.bag");
  write_bag("h/exp21_outside_building.bag");
  write_file(folder_ / "h/exp_04_construction_upper_level_imu.txt", "10 4 0 0 0 0 0 1\n");
  write_file(folder_ / "h/exp14_basement_2_imu.txt", "10 14 0 0 0 0 0 1\n");
  Eigen::Matrix3d turned;
  turned << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  expect_pose(*open("h/exp04_construction_upper_level.bag"), {3.999, -0.00855, 0.055}, turned,
              "exp_04_construction_upper_level_imu.txt, by the convention of Hilti 2022");
  expect_pose(*open("h/exp14_basement_2.bag"), {13.999, -0.00855, 0.055}, turned, "exp14_basement");
  EXPECT_TRUE(open("h/exp21_outside_building.bag")->ground_truth().empty());
}

TEST_F(TruthConventions, OxfordSpires) {
  write_file(folder_ / "keble/raw/lidar-clouds/1710338123.500000000.pcd",
             "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
             "POINTS 1\nDATA ascii\n1 2 3\n");
  write_file(folder_ / "keble/processed/trajectory/gt-tum.txt",
             "# timestamp tx ty tz qx qy qz qw\n1710338123.5 0 0 0 0 0 0 1\n");
  expect_pose(*open("keble"), {0, 0, 0.124}, about_z(180.0),
              "gt-tum.txt, by the convention of Oxford Spires");
}

// Heading turns the other way than a rotation about z; position is easting, northing, altitude.
TEST_F(TruthConventions, Boreas) {
  write_file(folder_ / "b/lidar/1605635976234567.bin", Bytes().floats(1, 2, 3, 4, 5, 0.01));
  write_file(folder_ / "b/applanix/lidar_poses.csv",
             "GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,heading,"
             "angvel_z,angvel_y,angvel_x\n"
             "1605635976234567,100.5,200.25,3,0,0,0,0,0,0.5,0,0,0\n");
  for (const char* path : {"b", "b/lidar"}) {
    const auto recording = open(path);
    expect_pose(*recording, {100.5, 200.25, 3}, about_z(-0.5 * 180.0 / M_PI),
                "lidar_poses.csv, by the convention of Boreas, of the LiDAR itself");
    EXPECT_EQ(recording->ground_truth()[0].stamp, 1'605'635'976'234'567'000);
    EXPECT_EQ(recording->stamp(0), 1'605'635'976'234'567'000);
  }
  // Roll about x, then pitch about y, each the other way: x forward goes to Rx(-r) Ry(-p) x.
  write_file(folder_ / "b/applanix/lidar_poses.csv",
             "1605635976234567,0,0,0,0,0,0,0.3,0.2,0,0,0,0\n");
  const Eigen::Vector3d ahead =
      open("b")->ground_truth()[0].pose.rotation * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(ahead.x(), std::cos(0.2), 1e-12);
  EXPECT_NEAR(ahead.y(), std::sin(0.2) * std::sin(0.3), 1e-12);
  EXPECT_NEAR(ahead.z(), std::sin(0.2) * std::cos(0.3), 1e-12);
}

TEST_F(TruthConventions, AFileOfTheBagsNameIsItsTruth) {
  write_bag("d/a.bag");
  write_bag("d/b.bag");
  write_file(folder_ / "d/a.txt", "10 1 2 3 0 0 0 1\n");
  write_file(folder_ / "d/poses.txt", "10 7 7 7 0 0 0 1\n");  // of which of them?
  expect_pose(*open("d/a.bag"), {1, 2, 3}, about_z(0.0), "a.txt, taken to be of the LiDAR");
  EXPECT_TRUE(open("d/b.bag")->ground_truth().empty());
  // What is no trajectory costs no recording.
  write_file(folder_ / "d/b.txt", "recorded on a rainy day\n");
  const auto recording = open("d/b.bag");
  EXPECT_TRUE(recording->ground_truth().empty());
  EXPECT_THAT(recording->info().warnings, Contains(HasSubstr("No ground truth is taken: ")));
}

}  // namespace
}  // namespace groundloop
