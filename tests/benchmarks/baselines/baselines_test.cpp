// Each detector of others on a case made by hand, whose answer follows from its paper.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/benchmarks/baselines/binary_triangles.hpp"
#include "tests/benchmarks/baselines/corner_image.hpp"
#include "tests/benchmarks/baselines/scan_context.hpp"
#include "tests/benchmarks/baselines/solid.hpp"
#include "tests/benchmarks/baselines/stable_triangles.hpp"

namespace groundloop::baselines {
namespace {

constexpr double kDegrees = std::numbers::pi / 180;

Eigen::Vector3f at(double radius, double azimuth_deg, double z) {
  return Eigen::Vector3d(radius * std::cos(azimuth_deg * kDegrees),
                         radius * std::sin(azimuth_deg * kDegrees), z)
      .cast<float>();
}

TEST(ScanContext, HoldsTheGreatestHeightOfEachBin) {
  // Rings of 4 m, sectors of 6 degrees; heights count from 2 m below the sensor.
  const ScanContext context =
      scan_context({at(10, 3, 1), at(11, 3, 0.5), at(10, 9, -1.5), at(79, 357, 4), at(81, 3, 9)});
  EXPECT_NEAR(context(2, 0), 3.0, 1e-6);
  EXPECT_NEAR(context(2, 1), 0.5, 1e-6);
  EXPECT_NEAR(context(19, 59), 6.0, 1e-6);
  EXPECT_EQ((context.array() > 0).count(), 3);
  EXPECT_NEAR(ring_key(context)(2), 3.5 / 60, 1e-6);
}

TEST(ScanContext, ATurnedScanIsTheSameAndAnotherIsNot) {
  Points scan, turned, other;
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 400; ++i) {
    const double radius = 5 + 70 * unit(rng), azimuth = 6 * std::floor(60 * unit(rng)) + 3,
                 z = 8 * unit(rng);
    scan.push_back(at(radius, azimuth, z));
    turned.push_back(at(radius, azimuth + 6 * 17, z));
    other.push_back(at(5 + 70 * unit(rng), 360 * unit(rng), 8 * unit(rng)));
  }
  EXPECT_NEAR(scan_context_distance(scan_context(scan), scan_context(turned)), 0.0, 1e-6);
  EXPECT_GT(scan_context_distance(scan_context(scan), scan_context(other)), 0.3);
}

TEST(Solid, WeighsRangesByHowFullTheirElevationsAre) {
  // 32 elevations of 1 degree, 40 ranges of 2 m. Three points in one elevation, one in another, so
  // that they weigh 1 and 1/3; the emptiest have none.
  const FieldOfView view{-16, 16};
  const auto point = [](double range, double azimuth, double elevation) {
    return at(range, azimuth, range * std::tan(elevation * kDegrees));
  };
  const Solid d =
      solid({point(10, 0, 0.5), point(10, 90, 0.5), point(20, 0, 0.5), point(20, 180, 8.5)}, view);
  EXPECT_NEAR(d(static_cast<int>(10 / 2.0)), 2.0, 1e-9);
  EXPECT_NEAR(d(static_cast<int>(20 / 2.0)), 1.0 + 1.0 / 3, 1e-9);
  EXPECT_NEAR(d.sum(), 3 + 1.0 / 3, 1e-9);
  EXPECT_NEAR(solid_similarity(d, 3 * d), 1.0, 1e-12);
  EXPECT_EQ(solid_similarity(d, Solid::Zero()), 0.0);
}

TEST(FieldOfViewOf, LeavesOutStrays) {
  Points scan;
  for (int i = 0; i < 2000; ++i)
    scan.push_back(at(10, 0.1 * i, 10 * std::tan(kDegrees * (i % 41 - 30))));
  scan.push_back(at(1, 0, 50));
  const FieldOfView view = field_of_view({scan});
  EXPECT_NEAR(view.down_deg, -30, 1e-3);
  EXPECT_NEAR(view.up_deg, 10, 1e-3);
}

KeyPoint key(double x, double y, double strength) {
  KeyPoint k;
  k.position = {x, y, 0};
  k.strength = strength;
  return k;
}

TEST(KeyPoints, TheStrongestOfNeighboursStays) {
  const auto kept = strongest({key(0, 0, 5), key(1, 0, 7), key(10, 0, 3), key(30, 0, 4)}, 2);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_DOUBLE_EQ(kept[0].strength, 7);
  EXPECT_DOUBLE_EQ(kept[1].strength, 4);
}

TEST(Triangles, AreOncePerTripleWithSortedSidesAndCornersByTheirRoles) {
  // A right triangle of 3, 4 and 5 m, and a fourth point too far away.
  const auto found = triangles({key(0, 0, 1), key(3, 0, 2), key(0, 4, 3), key(200, 0, 9)}, 0.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR((found[0].sides - Eigen::Vector3d(15, 20, 25)).norm(), 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(found[0].corners[0].strength, 1);  // between the shorter two
  EXPECT_DOUBLE_EQ(found[0].corners[1].strength, 2);  // between the shortest and the longest
  EXPECT_DOUBLE_EQ(found[0].corners[2].strength, 3);
  EXPECT_TRUE(triangles({key(0, 0, 1), key(3, 0, 2), key(6, 0.1, 3)}, 0.2).empty());  // a line
}

TEST(TriangleDatabase, FindsAFrameThatWasMovedAndHow) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> anywhere(-40, 40);
  std::vector<KeyPoint> here, elsewhere;
  for (int i = 0; i < 25; ++i) {
    here.push_back(key(anywhere(rng), anywhere(rng), 20));
    elsewhere.push_back(key(anywhere(rng), anywhere(rng), 20));
  }
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d t(30, -12, 1);
  std::vector<KeyPoint> moved = here;
  for (KeyPoint& k : moved) k.position = R * k.position + t;
  FlatVoxel ground;
  Frame a, b, query;
  a.triangles = triangles(moved, 0.0);
  a.planes = {ground};
  a.planes[0].centre = R * ground.centre + t;
  b.triangles = triangles(elsewhere, 0.0);
  b.planes = {ground};
  query.triangles = triangles(here, 0.0);
  query.planes = {ground};
  TriangleDatabase database(alike_in_points);
  database.insert(b);
  database.insert(a);
  const auto found = database.search(query, [](const Frame&) { return true; });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].frame, 1U);
  EXPECT_NEAR((found[0].rotation - R).norm(), 0.0, 1e-9);
  EXPECT_NEAR((found[0].translation - t).norm(), 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(found[0].score, 1.0);
  EXPECT_TRUE(database.search(query, [](const Frame&) { return false; }).empty());
}

TEST(BinaryTriangles, KeyPointsAreWhatStandsAloneOnTheGround) {
  std::vector<Eigen::Vector3d> cloud;
  for (double x = -20; x < 20; x += 0.2) {
    for (double y = -20; y < 20; y += 0.2) cloud.emplace_back(x, y, -1.8);
  }
  // A pole of 3 m, a box of 0.5 m, and a wall of 3 m along y.
  for (double z = -1.8; z < 1.2; z += 0.05) {
    cloud.emplace_back(5.25, 5.25, z);
    for (double y = -15; y < -5; y += 0.1) cloud.emplace_back(-10.25, y, z);
  }
  for (double z = -1.8; z < -1.3; z += 0.05) cloud.emplace_back(8.25, -8.25, z);
  const FlatVoxel ground = largest_plane(plane_voxels(cloud), cloud.front());
  EXPECT_NEAR(ground.normal.z(), 1.0, 1e-6);
  EXPECT_NEAR(ground.centre.z(), -1.8, 1e-3);
  const auto corners = height_corners(cloud, ground);
  ASSERT_GE(corners.size(), 1U);
  int of_the_pole = 0;
  for (const KeyPoint& c : corners) {
    const bool pole = (c.position.head<2>() - Eigen::Vector2d(5.25, 5.25)).norm() < 0.3;
    const bool end_of_the_wall =
        std::abs(c.position.x() + 10.25) < 0.3 &&
        (std::abs(c.position.y() + 15) < 1 || std::abs(c.position.y() + 5) < 1);
    EXPECT_TRUE(pole || end_of_the_wall) << c.position.transpose();
    of_the_pole += pole ? 1 : 0;
    if (pole) {
      EXPECT_NEAR(c.strength, 30, 2);
    }
  }
  EXPECT_EQ(of_the_pole, 1);
}

TEST(BinaryTriangles, CompareTheHeightsOfTheirCorners) {
  Triangle a, b;
  for (std::size_t i = 0; i < 3; ++i) {
    a.corners[i].heights = std::bitset<50>("1111111111");
    b.corners[i].heights = std::bitset<50>("1111111100");
  }
  EXPECT_TRUE(alike_in_heights(a, b));  // 2 * 8 / 18
  for (std::size_t i = 0; i < 3; ++i) b.corners[i].heights = std::bitset<50>("11110000001111");
  EXPECT_FALSE(alike_in_heights(a, b));  // 2 * 4 / 18
}

TEST(StableTriangles, KeyPointsLieWhereABorderOfAPlaneHoldsManyPoints) {
  std::vector<Eigen::Vector3d> cloud;
  // Ground over several voxels, and a bush on it: no plane, many points in one pixel.
  for (double x = 0.05; x < 12; x += 0.2) {
    for (double y = 0.05; y < 6; y += 0.2) {
      if (x < 8 || x > 10 || y < 2 || y > 4) cloud.emplace_back(x, y, 0.1);
    }
  }
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 60; ++i)
    cloud.emplace_back(8 + 2 * unit(rng), 2 + 2 * unit(rng), 2 * unit(rng));
  for (int i = 0; i < 40; ++i)
    cloud.emplace_back(9.0 + 0.2 * unit(rng), 3.0 + 0.2 * unit(rng), 2 * unit(rng));
  const auto corners = border_corners(plane_voxels(cloud));
  ASSERT_FALSE(corners.empty());
  EXPECT_NEAR(corners[0].position.x(), 9.1, 0.4);
  EXPECT_NEAR(corners[0].position.y(), 3.1, 0.4);
  EXPECT_GE(corners[0].strength, 40);
}

}  // namespace
}  // namespace groundloop::baselines
