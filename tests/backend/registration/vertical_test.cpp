#include "backend/registration/vertical.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "frontend/core/pose.hpp"
#include "tests/support/street_scene.hpp"

namespace groundloop {
namespace {

constexpr double kDegree = M_PI / 180.0;

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, a.dot(b)));
}

// A rectangle of n points with 2 cm of noise.
void add_plane(Points& points, const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
               const Eigen::Vector3d& v, std::size_t n, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> unit;
  std::normal_distribution<double> noise(0.0, 0.02);
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Vector3d p = corner + unit(generator) * u + unit(generator) * v;
    for (int k = 0; k < 3; ++k) p[k] += noise(generator);
    points.push_back(p.cast<float>());
  }
}

TEST(Vertical, IsThatOfTheWallsHoweverTheMapIsTurned) {
  const testing::StreetScene scene(3);
  for (const double degrees : {0.0, 10.0, 30.0}) {
    const Pose T(exp_so3({0.8 * degrees * kDegree, -0.6 * degrees * kDegree, 0.0}),
                 {3.0, -2.0, 1.0});
    const MapVertical vertical =
        find_vertical(testing::transformed(scene.sample(300000, 0.02, 7), T));
    const Eigen::Vector3d expected = T.rotation * Eigen::Vector3d::UnitZ();
    // Cells that cut the foot of a wall lean; a map may err by a quarter degree (levelling.hpp).
    EXPECT_LT(angle(vertical.up, expected), 0.2 * kDegree) << degrees;
    EXPECT_GT(vertical.surfaces, 300u);
  }
}

TEST(Vertical, IsNotTurnedByASlope) {
  // A street that climbs at 8 degrees between upright walls.
  Points points;
  const double rise = std::tan(8.0 * kDegree);
  add_plane(points, {-40, -10, -40 * rise}, {80, 0, 80 * rise}, {0, 20, 0}, 100000, 1);
  for (const double y : {-10.0, 10.0})
    add_plane(points, {-40, y, -6}, {80, 0, 0}, {0, 0, 14}, 60000, y > 0 ? 2 : 3);
  for (const double x : {-40.0, 0.0, 40.0})
    add_plane(points, {x, 10, -6}, {0, 8, 0}, {0, 0, 14}, 8000, static_cast<std::uint32_t>(x + 90));
  const MapVertical vertical = find_vertical(points);
  EXPECT_LT(angle(vertical.up, Eigen::Vector3d::UnitZ()), 0.1 * kDegree);
}

TEST(Vertical, KnowsLittleAlongAStreetOfParallelWalls) {
  Points points;
  add_plane(points, {-40, -10, 0}, {80, 0, 0}, {0, 20, 0}, 100000, 1);
  for (const double y : {-10.0, 10.0})
    add_plane(points, {-40, y, 0}, {80, 0, 0}, {0, 0, 10}, 60000, y > 0 ? 2 : 3);
  const MapVertical vertical = find_vertical(points);
  // The walls face y: leaning across the street shows, leaning along it does not.
  EXPECT_GT(vertical.information(1, 1), 100.0 * vertical.information(0, 0));
}

TEST(Vertical, SaysNothingWithoutWalls) {
  Points points;
  add_plane(points, {-40, -40, 0}, {80, 0, 0}, {0, 80, 0}, 100000, 1);
  EXPECT_TRUE(find_vertical(points).information.isZero(0.0));
  EXPECT_TRUE(find_vertical({}).information.isZero(0.0));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(find_vertical(Points(1000, Eigen::Vector3f(nan, 1, 1e9F))).information.isZero(0.0));
  EXPECT_TRUE(find_vertical(Points(1000, Eigen::Vector3f(1, 1, 1))).information.isZero(0.0));
}

}  // namespace
}  // namespace groundloop
