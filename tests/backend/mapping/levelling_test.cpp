#include "backend/mapping/levelling.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

constexpr double kDegree = M_PI / 180.0;

// A drive over flat ground along the sides of a square of 400 m, three times with growing squares,
// as it was and as an odometry that tilts saw it.
struct Drive {
  Trajectory truth, odometry;
  std::vector<LocalMapRecord> maps;
  std::vector<MapVertical> verticals;
};

// `bend` in rad/m; `walk` is the standard deviation of roll and pitch gained in a metre; verticals
// have errors of `noise` rad, and every `wrong`th leans by 6 degrees.
Drive drive(double bend, double walk, double noise, int wrong, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Drive result;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  double heading = 0.0;
  int scan = 0;
  for (int lap = 0; lap < 3; ++lap) {
    for (int side = 0; side < 4; ++side) {
      for (int i = 0; i < 400 + 60 * lap; ++i) {
        const Pose pose(exp_so3({0, 0, heading}), place);
        result.truth.push_back({100000000LL * scan++, pose});
        place += pose.rotation * Eigen::Vector3d(1, 0, 0);
      }
      heading += M_PI / 2;
    }
  }
  Eigen::Vector2d wandered = Eigen::Vector2d::Zero();
  std::vector<Eigen::Quaterniond> turned;
  for (std::size_t i = 0; i < result.truth.size(); ++i) {
    const Eigen::Vector2d lean = wandered - bend * result.truth[i].pose.translation.head<2>();
    turned.push_back(exp_so3({-lean.y(), lean.x(), 0.0}));
    wandered += walk * Eigen::Vector2d(normal(generator), normal(generator));
    Pose pose(turned.back() * result.truth[i].pose.rotation, Eigen::Vector3d::Zero());
    if (i > 0) {
      const Eigen::Vector3d step =
          result.truth[i - 1].pose.rotation.conjugate() *
          (result.truth[i].pose.translation - result.truth[i - 1].pose.translation);
      pose.translation =
          result.odometry.back().pose.translation + result.odometry.back().pose.rotation * step;
    }
    result.odometry.push_back({result.truth[i].stamp, pose});
  }
  constexpr std::size_t kScans = 80;
  for (std::size_t first = 0; first < result.truth.size(); first += kScans) {
    const std::size_t last = std::min(first + kScans, result.truth.size()) - 1;
    result.maps.push_back({static_cast<int>(result.maps.size()), first, last, 0, {}});
    MapVertical vertical;
    // What a wall at the middle of the map says.
    const Eigen::Vector3d error(noise * normal(generator), noise * normal(generator), 0.0);
    const bool leans = wrong > 0 && result.maps.size() % static_cast<std::size_t>(wrong) == 0;
    vertical.up = result.odometry[first].pose.rotation.conjugate() *
                  (turned[(first + last) / 2] *
                   (exp_so3(error + Eigen::Vector3d(leans ? 6.0 * kDegree : 0.0, 0, 0)) *
                    Eigen::Vector3d::UnitZ()));
    const Eigen::Matrix3d across =
        Eigen::Matrix3d::Identity() - vertical.up * vertical.up.transpose();
    vertical.information = across * 6.0 / (0.1 * kDegree * 0.1 * kDegree);
    vertical.surfaces = 500;
    result.verticals.push_back(vertical);
  }
  return result;
}

double worst_height(const Trajectory& trajectory) {
  double worst = 0.0;
  for (const StampedPose& sample : trajectory)
    worst = std::max(worst, std::abs(sample.pose.translation.z()));
  return worst;
}

TEST(Levelling, UnbendsABowl) {
  const Drive d = drive(1e-4, 0.0, 0.2 * kDegree, 0, 1);
  EXPECT_GT(worst_height(d.odometry), 10.0);
  const Levelling levelling = level_odometry(d.odometry, d.maps, d.verticals, {});
  ASSERT_TRUE(levelling.applied);
  EXPECT_NEAR(levelling.bend, 1e-4, 3 * levelling.bend_deviation);
  EXPECT_LT(levelling.bend_deviation, 1e-5);
  EXPECT_LT(worst_height(levelling.odometry), 1.5);
}

TEST(Levelling, StopsWanderingRollAndPitch) {
  const Drive d = drive(0.0, 1e-3, 0.2 * kDegree, 0, 2);
  EXPECT_GT(worst_height(d.odometry), 20.0);
  const Levelling levelling = level_odometry(d.odometry, d.maps, d.verticals, {});
  ASSERT_TRUE(levelling.applied);
  EXPECT_LT(worst_height(levelling.odometry), 0.25 * worst_height(d.odometry));
  EXPECT_GT(levelling.walk_scale, 1.0);  // 1e-3 against the stated 5e-4 rad/sqrt(m)
}

TEST(Levelling, LeavesAGoodOdometryAlone) {
  // The verticals are far worse than the odometry, and it shows in them.
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Drive d = drive(0.0, 0.0, 0.4 * kDegree, 0, seed);
    const Levelling levelling = level_odometry(d.odometry, d.maps, d.verticals, {});
    EXPECT_LT(worst_height(levelling.odometry), 1.5) << seed;
  }
}

TEST(Levelling, IsNotBentByMapsOfLeaningThings) {
  const Drive d = drive(1e-4, 0.0, 0.2 * kDegree, 4, 3);
  const Levelling levelling = level_odometry(d.odometry, d.maps, d.verticals, {});
  ASSERT_TRUE(levelling.applied);
  EXPECT_LT(worst_height(levelling.odometry), 1.5);
}

TEST(Levelling, KeepsTheFirstPoseAndEveryStep) {
  const Drive d = drive(1e-4, 5e-4, 0.2 * kDegree, 0, 4);
  const Levelling levelling = level_odometry(d.odometry, d.maps, d.verticals, {});
  ASSERT_EQ(levelling.odometry.size(), d.odometry.size());
  EXPECT_TRUE(
      levelling.odometry.front().pose.rotation.isApprox(d.odometry.front().pose.rotation, 1e-12));
  for (std::size_t i = 1; i < d.odometry.size(); ++i) {
    const Pose before = d.odometry[i - 1].pose.inverse() * d.odometry[i].pose;
    const Pose after = levelling.odometry[i - 1].pose.inverse() * levelling.odometry[i].pose;
    ASSERT_NEAR((before.translation - after.translation).norm(), 0.0, 1e-9);
    ASSERT_EQ(levelling.odometry[i].stamp, d.odometry[i].stamp);
  }
}

TEST(Levelling, NeedsMapsWithWalls) {
  Drive d = drive(1e-4, 0.0, 0.0, 0, 5);
  for (std::size_t m = 3; m < d.verticals.size(); ++m) d.verticals[m] = {};
  const Levelling levelling = level_odometry(d.odometry, d.maps, d.verticals, {});
  EXPECT_FALSE(levelling.applied);
  EXPECT_EQ(levelling.maps, 3u);
  EXPECT_EQ(levelling.odometry.back().pose.translation, d.odometry.back().pose.translation);
  EXPECT_FALSE(level_odometry({}, {}, {}, {}).applied);
}

TEST(Levelling, HoldsForASensorThatStartsTilted) {
  Drive d = drive(1e-4, 0.0, 0.1 * kDegree, 0, 6);
  const Pose tilt(exp_so3({0.3, -0.4, 0.2}), Eigen::Vector3d::Zero());
  for (StampedPose& sample : d.odometry) sample.pose = tilt * sample.pose;
  const Levelling levelling = level_odometry(d.odometry, d.maps, d.verticals, {});
  ASSERT_TRUE(levelling.applied);
  Trajectory upright = levelling.odometry;
  for (StampedPose& sample : upright) sample.pose = tilt.inverse() * sample.pose;
  EXPECT_LT(worst_height(upright), 1.5);
}

}  // namespace
}  // namespace groundloop
