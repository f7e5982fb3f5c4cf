#include "backend/evaluation/map_measures.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "backend/evaluation/map_comparison.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::TemporaryFolder;

// A wall of 20 x 6 m at y = 0.5, its points off it by a normal deviation and an offset.
std::vector<Eigen::Vector3d> wall(double deviation, double offset, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 60'000; ++i) {
    points.emplace_back(20.0 * uniform(generator), 0.5 + offset + deviation * normal(generator),
                        6.0 * uniform(generator));
  }
  return points;
}

MapMeasures measure(
    const std::vector<std::pair<std::uint32_t, std::vector<Eigen::Vector3d>>>& map) {
  const TemporaryFolder folder;
  PointTiles tiles(folder.path(), 10.0);
  for (const auto& [tag, points] : map) {
    std::vector<WorldPoint> tagged;
    for (const Eigen::Vector3d& p : points) tagged.push_back({p, 0.0F, tag});
    tiles.add(tagged);
  }
  return measure_map(tiles, 1.0);
}

TEST(MapMeasures, ThicknessOfAWallIsItsNoise) {
  const MapMeasures m = measure({{0, wall(0.02, 0.0, 1)}});
  EXPECT_EQ(m.planes.cells, 120U);
  EXPECT_NEAR(m.planes.mean_m, 0.02, 4e-4);
  EXPECT_EQ(m.revisited.cells, 0U);
  EXPECT_NEAR(m.judged_share, 1.0, 1e-12);
}

TEST(MapMeasures, AWallInTwoPlacesIsThickAndNotLeftOut) {
  // Half of the points each, 0.2 m apart: sqrt(0.02^2 + 0.1^2).
  const MapMeasures m = measure({{0, wall(0.02, 0.0, 1)}, {7, wall(0.02, 0.2, 2)}});
  EXPECT_EQ(m.planes.cells, 120U);
  EXPECT_EQ(m.revisited.cells, 120U);
  EXPECT_NEAR(m.revisited.mean_m, std::sqrt(0.02 * 0.02 + 0.1 * 0.1), 2e-3);
}

TEST(MapMeasures, StretchesThatFollowOneAnotherAreOneVisit) {
  const MapMeasures m = measure({{3, wall(0.02, 0.0, 1)}, {4, wall(0.02, 0.0, 2)}});
  EXPECT_EQ(m.planes.cells, 120U);
  EXPECT_EQ(m.revisited.cells, 0U);
}

TEST(MapMeasures, EntropyIsThatOfTheCellsCovariance) {
  const MapMeasures m = measure({{0, wall(0.05, 0.0, 3)}});
  const double variance = 1.0 / 12.0 + 1e-4;
  const double expected =
      0.5 * std::log(std::pow(2.0 * M_PI * M_E, 3) * variance * variance * (0.05 * 0.05 + 1e-4));
  EXPECT_NEAR(m.entropy, expected, 0.02);
}

TEST(MapMeasures, BushesAreNoPlanes) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0.0, 10.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 100'000; ++i)
    points.emplace_back(uniform(generator), uniform(generator), uniform(generator) / 5.0);
  const MapMeasures m = measure({{0, points}});
  EXPECT_EQ(m.planes.cells, 0U);
  EXPECT_EQ(m.judged_share, 0.0);
}

Points cloud(const std::vector<Eigen::Vector3d>& points, const Pose& pose = {}) {
  Points result;
  for (const Eigen::Vector3d& p : points) result.push_back((pose * p).cast<float>());
  return result;
}

TEST(MapComparison, WassersteinOfGaussiansIsTheClosedForm) {
  // Equal covariances: the distance of the means. Diagonal ones: of the deviations, too.
  const Eigen::Matrix3d c = Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal();
  EXPECT_NEAR(wasserstein_squared({1, 2, 3}, c, {1, 2, 5}, c), 4.0, 1e-12);
  const Eigen::Matrix3d a = Eigen::Vector3d(1.0, 4.0, 9.0).asDiagonal();
  const Eigen::Matrix3d b = Eigen::Vector3d(4.0, 4.0, 1.0).asDiagonal();
  EXPECT_NEAR(wasserstein_squared({0, 0, 0}, a, {0, 0, 0}, b), 1.0 + 0.0 + 4.0, 1e-9);
}

TEST(MapComparison, AShiftedHalfIsAsFarAndAsIncompleteAsItIs) {
  // A grid of 0.2 m, more than half of it missing, the rest 0.05 m off along z.
  Points truth;
  Points map;
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 200; ++j) {
      truth.emplace_back(0.2F * static_cast<float>(i), 0.2F * static_cast<float>(j), 0.0F);
      if (i < 90) map.push_back(truth.back() + Eigen::Vector3f(0.0F, 0.0F, 0.05F));
    }
  }
  const MapComparison c = compare_maps(map, truth, 0.1, 3.0);
  EXPECT_NEAR(c.accuracy_m, 0.05, 1e-6);
  EXPECT_NEAR(c.matched_share, 1.0, 1e-12);
  EXPECT_NEAR(c.completeness, 0.45, 1e-3);
  EXPECT_NEAR(c.chamfer_m, 0.05, 1e-4);
  EXPECT_NEAR(c.wasserstein_m, 0.05, 1e-3);
  EXPECT_GT(c.voxels, 50U);
}

TEST(MapComparison, AlignmentFindsTheKnownPose) {
  std::vector<Eigen::Vector3d> points = wall(0.01, 0.0, 1);
  for (const Eigen::Vector3d& p : wall(0.01, 0.0, 2)) points.emplace_back(p.y(), p.x(), p.z());
  for (const Eigen::Vector3d& p : wall(0.01, 0.0, 3))
    points.emplace_back(p.x(), 3.0 * p.z(), p.y());
  const Pose T_truth_map(exp_so3({0.01, -0.02, 0.03}), Eigen::Vector3d(0.2, -0.1, 0.15));
  const Pose found = align_maps(cloud(points), cloud(points, T_truth_map), Pose(), 1.0);
  const Pose error = T_truth_map.inverse() * found;
  EXPECT_LT(error.translation.norm(), 2e-3);
  EXPECT_LT(rotation_angle(error.rotation), 2e-4);
}

}  // namespace
}  // namespace groundloop
