#include "frontend/odometry/voxel_map.hpp"

#include <map>
#include <random>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

Points random_points(std::size_t n, float extent, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> uniform(-extent, extent);
  Points points(n);
  for (auto& p : points) p = {uniform(rng), uniform(rng), uniform(rng)};
  return points;
}

TEST(VoxelTable, BehavesLikeAStandardMapUnderInsertionAndRemoval) {
  std::mt19937_64 rng(7);
  VoxelTable table(4);
  std::map<VoxelKey, std::uint32_t> reference;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const VoxelKey key = rng() % 3000;
    if (rng() % 3 == 0) {
      table.erase(key);
      reference.erase(key);
    } else {
      EXPECT_EQ(table.find_or_insert(key, i), reference.emplace(key, i).first->second);
    }
  }
  EXPECT_EQ(table.size(), reference.size());
  for (VoxelKey key = 0; key < 3000; ++key) {
    const auto it = reference.find(key);
    EXPECT_EQ(table.find(key), it == reference.end() ? VoxelTable::kNone : it->second);
  }
}

TEST(VoxelTable, KeysTurnBackIntoVoxels) {
  for (const Eigen::Vector3i& v :
       {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(-1, 5, -700000), Eigen::Vector3i(99999, -3, 2)}) {
    EXPECT_EQ(voxel_from_key(voxel_key(v)), v);
  }
  EXPECT_EQ(voxel_of({-0.1F, 0.1F, -1.0F}, 1.0F), Eigen::Vector3i(-1, 0, -1));
}

// Random points are spaced, so that none is left out by the spacing rule, and few enough for the 20
// of a voxel.
TEST(VoxelMap, NearestAgreesWithBruteForceOverTheNeighbouringVoxels) {
  VoxelMap map(1.0F);
  Points kept;
  for (const Eigen::Vector3f& p : random_points(4000, 8.0F, 3)) {
    bool close = false;
    for (const auto& q : kept) close = close || (p - q).squaredNorm() < 0.06F;
    if (!close) kept.push_back(p);
  }
  map.insert(kept, Pose());
  for (const Eigen::Vector3f& p : random_points(500, 9.0F, 4)) {
    for (const float bound : {0.3F, 0.9F}) {
      float best = INFINITY;
      for (const auto& q : kept) best = std::min(best, (p - q).squaredNorm());
      const VoxelMap::Neighbor neighbor = map.nearest(MapAnchor{}, p, bound);
      if (best <= bound * bound) {
        EXPECT_NEAR(neighbor.squared_distance, best, 1e-5F);
      } else {
        EXPECT_GT(neighbor.squared_distance, bound * bound);
      }
    }
  }
}

TEST(VoxelMap, KeepsPointsApartAndAtMostTwentyAVoxel) {
  VoxelMap map(1.0F);
  map.insert(Points(100, Eigen::Vector3f(0.5F, 0.5F, 0.5F)), Pose());
  EXPECT_EQ(map.voxels(), 1U);
  EXPECT_EQ(map.nearest(MapAnchor{}, {0.5F, 0.5F, 0.6F}, 1.0F).point,
            Eigen::Vector3f(0.5F, 0.5F, 0.5F));
}

// Two scan lines on a wall, 1.2 m apart: no voxel of 1 m holds more than one of them.
TEST(VoxelMap, ScanLinesOfOneWallGiveItsPlaneThoughNoVoxelHoldsTwo) {
  VoxelMap map(1.0F);
  Points lines;
  for (int i = 0; i < 30; ++i) {
    for (const float z : {0.5F, 1.7F}) lines.emplace_back(0.1F * static_cast<float>(i), 0.4F, z);
  }
  map.insert(lines, Pose());
  const VoxelMap::Neighbor neighbor = map.nearest(MapAnchor{}, {1.2F, 0.5F, 0.6F}, 1.0F);
  ASSERT_TRUE(neighbor.plane.exists());
  EXPECT_NEAR(std::abs(neighbor.plane.normal.y()), 1.0F, 1e-5F);
  EXPECT_NEAR(neighbor.plane.distance({1.2F, 0.5F, 0.6F}) * neighbor.plane.normal.y(), 0.1F, 1e-5F);
  // A pole that stands before the wall is not of its plane.
  Points pole;
  for (int i = 0; i < 5; ++i) pole.emplace_back(1.5F, 0.9F, 0.25F * static_cast<float>(i));
  map.insert(pole, Pose());
  EXPECT_FALSE(map.nearest(MapAnchor{}, {1.5F, 0.95F, 0.5F}, 1.0F).plane.exists());
}

// The nearest point stays so while the query moves by less than its reach.
TEST(VoxelMap, ANeighbourStaysTheNearestWithinItsReach) {
  VoxelMap map(1.0F);
  map.insert(random_points(4000, 8.0F, 5), Pose());
  const Points shifts = random_points(500, 1.0F, 7);
  std::size_t moved = 0;
  for (std::size_t i = 0; const Eigen::Vector3f& p : random_points(500, 7.0F, 6)) {
    const VoxelMap::Neighbor neighbor = map.nearest(MapAnchor{}, p, 0.9F);
    const Eigen::Vector3f q = p + 0.99F * neighbor.reach * shifts[i++].normalized();
    if (neighbor.reach <= 0.0F) continue;
    ++moved;
    const VoxelMap::Neighbor again = map.nearest(MapAnchor{}, q, 2.0F);
    EXPECT_LT((again.point - neighbor.point).norm(), 1e-6F);
  }
  EXPECT_GT(moved, 300U);
}

// Far from the start points are as exact as near it: single precision would keep 8 mm there.
TEST(VoxelMap, KeepsPointsExactlyAHundredKilometresAway) {
  VoxelMap map(1.0F);
  const Eigen::Vector3d far(100'000.25, -100'000.25, 20.25);
  const Points points = random_points(200, 8.0F, 8);
  map.insert(points, Pose(Eigen::Quaterniond::Identity(), far));
  const MapAnchor anchor = map.anchor_at(far);
  EXPECT_LT((anchor.position - far).norm(), 1.0);
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f query = p + (far - anchor.position).cast<float>();
    EXPECT_LT(map.nearest(anchor, query, 0.5F).squared_distance, 1e-10F);
  }
  map.remove_beyond(far, 3.0F);
  EXPECT_LT(map.voxels(), 30U);
  EXPECT_GT(map.voxels(), 0U);
}

TEST(VoxelMap, DropsWhatIsOutOfRangeAndReusesItsPlace) {
  VoxelMap map(1.0F);
  map.insert({{0.5F, 0.5F, 0.5F}, {50.0F, 0.0F, 0.0F}}, Pose());
  map.remove_beyond(Eigen::Vector3d::Zero(), 10.0F);
  EXPECT_EQ(map.voxels(), 1U);
  EXPECT_GT(map.nearest(MapAnchor{}, {50.0F, 0.0F, 0.0F}, 1.0F).squared_distance, 1.0F);
  map.insert({{50.0F, 0.0F, 0.0F}}, Pose());
  EXPECT_EQ(map.nearest(MapAnchor{}, {50.0F, 0.0F, 0.1F}, 1.0F).point,
            Eigen::Vector3f(50.0F, 0.0F, 0.0F));
}

}  // namespace
}  // namespace groundloop
