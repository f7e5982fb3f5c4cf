#include "loopclosure/voxel_normals.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

// Points of the ground and of a wall in turn, as a sensor with two kinds of rays may give them.
TEST(VoxelNormals, SampleBothSurfacesWhosePointsAlternate) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<float> along(0.0F, 10.0F);
  Points points;
  for (int i = 0; i < 20000; ++i) {
    points.emplace_back(along(rng), along(rng), 0.5F);
    points.emplace_back(along(rng), 20.5F, along(rng));
  }
  for (const std::size_t max_points : {40000U, 20000U, 10000U}) {
    const VoxelNormals voxels(points, 1.0, max_points);
    ASSERT_EQ(voxels.size(), 200U) << max_points;
    std::size_t level = 0, upright = 0;
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      level += static_cast<std::size_t>(std::abs(voxels.normal(i).z()) > 0.999F);
      upright += static_cast<std::size_t>(std::abs(voxels.normal(i).y()) > 0.999F);
    }
    EXPECT_EQ(level, 100U) << max_points;
    EXPECT_EQ(upright, 100U) << max_points;
  }
}

TEST(VoxelNormals, OfNoPointsAreNone) {
  EXPECT_EQ(VoxelNormals({}, 1.0, 10).size(), 0U);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(VoxelNormals({{nan, 0.0F, 0.0F}, {0.0F, 2e4F, 0.0F}}, 1.0, 10).size(), 0U);
}

}  // namespace
}  // namespace groundloop
