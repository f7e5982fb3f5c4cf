#include "loopclosure/ground_alignment.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

// A street: ground at z = -1.8 below the sensor, two rows of facades with gaps, trees.
Points street(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::normal_distribution<float> noise(0.0F, 0.02F);
  Points points;
  for (int i = 0; i < 60000; ++i) {
    points.emplace_back(-60 + 200 * unit(rng), -25 + 50 * unit(rng), -1.8F + noise(rng));
  }
  for (int i = 0; i < 40000; ++i) {
    const float x = -60 + 200 * unit(rng);
    if (std::fmod(x + 100, 25.0F) < 5) continue;
    const float y = unit(rng) < 0.5F ? -12.0F : 14.0F;
    points.emplace_back(x, y + noise(rng), -1.8F + 9 * unit(rng));
  }
  for (int tree = 0; tree < 30; ++tree) {
    const float x = -60 + 200 * unit(rng), y = -20 + 40 * unit(rng);
    for (int i = 0; i < 200; ++i) {
      points.emplace_back(x + 3 * unit(rng), y + 3 * unit(rng), 1 + 4 * unit(rng));
    }
  }
  return points;
}

Points moved(const Points& points, const Pose& T) {
  const PoseF transform(T);
  Points result;
  result.reserve(points.size());
  for (const Eigen::Vector3f& p : points) result.push_back(transform * p);
  return result;
}

double tilt_error_deg(const GroundAlignment& ground, const Pose& T_map_world) {
  const Eigen::Vector3d up =
      (ground.T_ground_map * T_map_world).rotation * Eigen::Vector3d::UnitZ();
  return std::acos(std::min(1.0, up.z())) * 180 / M_PI;
}

class TiltedStreet : public ::testing::TestWithParam<int> {};

TEST_P(TiltedStreet, IsLaidLevelAboutTenHorizontalAxes) {
  const Points points = street(1);
  for (int axis = 0; axis < 10; ++axis) {
    const double direction = 2 * M_PI * axis / 10;
    const Eigen::Vector3d w =
        Eigen::Vector3d(std::cos(direction), std::sin(direction), 0) * GetParam() * M_PI / 180;
    const Pose tilt(exp_so3(w), Eigen::Vector3d(0.5, -0.3, 0.2));
    const GroundAlignment ground = align_to_ground(moved(points, tilt), {});
    EXPECT_TRUE(ground.found);
    EXPECT_LT(tilt_error_deg(ground, tilt), 0.1) << "axis " << axis;
    // The ground itself comes to lie at height zero.
    const Eigen::Vector3d foot = ground.T_ground_map * (tilt * Eigen::Vector3d(0, 0, -1.8));
    EXPECT_NEAR(foot.z(), 0.0, 0.02) << "axis " << axis;
    EXPECT_GT(ground.quality, 0.8);
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, TiltedStreet,
                         ::testing::Values(0, 10, 20, 30, 40, 50, 60, 70, 80));

TEST(GroundAlignment, LeavesHeadingAndPlaceAlongALevelGround) {
  const GroundAlignment ground = align_to_ground(street(2), {});
  const Vector6d xi = log_se3(ground.T_ground_map);
  EXPECT_NEAR(xi(0), 0, 0.01);
  EXPECT_NEAR(xi(1), 0, 0.01);
  EXPECT_NEAR(xi(2), 1.8, 0.01);
  EXPECT_NEAR(xi.tail<3>().norm(), 0, 1e-3);
}

TEST(GroundAlignment, FollowsARamp) {
  // Everything stands on a slope of 8 degrees: the slope is the ground.
  const Pose slope(exp_so3({0, 8 * M_PI / 180, 0}), Eigen::Vector3d::Zero());
  EXPECT_LT(tilt_error_deg(align_to_ground(moved(street(3), slope), {}), slope), 0.1);
}

TEST(GroundAlignment, ResistsPointsBelowTheGround) {
  Points points = street(4);
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (int i = 0; i < 3000; ++i) {  // reflections in windows and puddles
    points.emplace_back(-60 + 200 * unit(rng), -25 + 50 * unit(rng), -8 + 5 * unit(rng));
  }
  const GroundAlignment ground = align_to_ground(points, {});
  EXPECT_LT(tilt_error_deg(ground, Pose()), 0.2);
  EXPECT_NEAR((ground.T_ground_map * Eigen::Vector3d(0, 0, -1.8)).z(), 0.0, 0.05);
}

TEST(GroundAlignment, WithoutGroundOnlyShiftsTheHeight) {
  std::mt19937_64 rng(6);
  std::uniform_real_distribution<float> unit(-20.0F, 20.0F);
  Points cloud;  // a fog of single points: no voxel is a plane
  for (int i = 0; i < 3000; ++i) cloud.emplace_back(unit(rng), unit(rng), unit(rng));
  const GroundAlignment ground = align_to_ground(cloud, {});
  EXPECT_FALSE(ground.found);
  EXPECT_EQ(ground.quality, 0.0);
  EXPECT_EQ(rotation_angle(ground.T_ground_map.rotation), 0.0);
  EXPECT_TRUE(ground.T_ground_map.translation.allFinite());
}

TEST(GroundAlignment, DegenerateMapsHaveDefinedResults) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Points> maps{{},
                                 {{1, 2, 3}},
                                 Points(1000, Eigen::Vector3f(1, 2, 3)),
                                 {{1e9F, 0, 0}, {nan, 0, 0}, {0, infinity, 0}},
                                 {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}};
  for (const Points& points : maps) {
    const GroundAlignment ground = align_to_ground(points, {});
    EXPECT_FALSE(ground.found);
    EXPECT_EQ(rotation_angle(ground.T_ground_map.rotation), 0.0);
    EXPECT_TRUE(ground.T_ground_map.translation.allFinite());
  }
  EXPECT_NEAR(align_to_ground(maps[1], {}).T_ground_map.translation.z(), -3.0, 1e-6);
}

TEST(GroundAlignment, AlongItsOwnAxisAloneStillLevelsAModerateTilt) {
  GroundAlignmentOptions paper;
  paper.directions = 1;
  paper.min_quality = 0;
  const Pose tilt(exp_so3({0.2, -0.15, 0}), Eigen::Vector3d(0, 0, 0.3));
  const GroundAlignment ground = align_to_ground(moved(street(8), tilt), paper);
  EXPECT_TRUE(ground.found);
  EXPECT_LT(tilt_error_deg(ground, tilt), 0.2);
}

TEST(GroundAlignment, OfLowestPointsIsThePlaneThroughThem) {
  GroundAlignmentOptions lowest;
  lowest.method = "lowest";
  lowest.cell_size = 5;
  // One point in the middle of each cell, on the plane z = -3 + 0.03 x - 0.02 y, and one above.
  Points points;
  for (int i = -10; i < 10; ++i) {
    for (int j = -10; j < 10; ++j) {
      const float x = 5.0F * static_cast<float>(i) + 2.5F, y = 5.0F * static_cast<float>(j) + 2.5F;
      points.emplace_back(x, y, -3 + 0.03F * x - 0.02F * y);
      points.emplace_back(x, y, 3.0F);
    }
  }
  const GroundAlignment ground = align_to_ground(points, lowest);
  EXPECT_TRUE(ground.found);
  EXPECT_EQ(ground.ground_cells, 400U);
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.03, 0.02, 1).normalized();
  EXPECT_NEAR((ground.T_ground_map.rotation * normal).z(), 1.0, 1e-6);
  EXPECT_NEAR((ground.T_ground_map * Eigen::Vector3d(0, 0, -3)).z(), 0.0, 1e-3);
  EXPECT_FALSE(align_to_ground({}, lowest).found);
  EXPECT_FALSE(align_to_ground({{0, 0, 1}, {9, 0, 1}, {0, 9, 1}}, lowest).found);
}

TEST(GroundAlignment, IgnoresAPointAtAMillionKilometres) {
  Points points = street(7);
  const GroundAlignment before = align_to_ground(points, {});
  points.emplace_back(1e9F, 1e9F, -1e9F);
  const GroundAlignment after = align_to_ground(points, {});
  EXPECT_LT((before.T_ground_map.matrix() - after.T_ground_map.matrix()).norm(), 1e-12);
}

}  // namespace
}  // namespace groundloop
