#include "frontend/local_maps/local_map_builder.hpp"

#include <gtest/gtest.h>

#include "frontend/core/pcd.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

Pose at(double x, double y = 0.0) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, y, 0)};
}

TEST(LocalMap, EndsOnceDisplacementExceedsTheLength) {
  LocalMapBuilder builder{LocalMapOptions{}};
  for (int i = 0; i <= 10; ++i)
    EXPECT_FALSE(builder.add({{1, 0, 0}}, at(10.0 * i)).has_value()) << i;
  const auto map = builder.add({{1, 0, 0}}, at(100.5));
  ASSERT_TRUE(map.has_value());
  EXPECT_EQ(map->first_scan, 0U);
  EXPECT_EQ(map->last_scan, 11U);
  const auto rest = builder.add({{1, 0, 0}}, at(110));
  EXPECT_FALSE(rest.has_value());
  const auto last = builder.finish();
  ASSERT_TRUE(last.has_value());
  EXPECT_EQ(last->id, 1);
  EXPECT_EQ(last->first_scan, 12U);
  EXPECT_EQ(last->last_scan, 12U);
  EXPECT_FALSE(builder.finish().has_value());
}

TEST(LocalMap, OfOneWhoCirclesInPlaceEndsByItsPath) {
  LocalMapBuilder builder{LocalMapOptions{}};
  int finished = 0;
  for (int i = 0; i < 1000; ++i)
    finished +=
        builder.add({{1, 0, 0}}, at(20 * std::cos(0.1 * i), 20 * std::sin(0.1 * i))) ? 1 : 0;
  // 2 m a step over 1000 steps is 2 km; a map ends after 300 m.
  EXPECT_EQ(finished, 6);
}

TEST(LocalMap, KeepsPointsInTheFrameOfItsFirstScan) {
  LocalMapBuilder builder{LocalMapOptions{}};
  const Pose first(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())),
                   Eigen::Vector3d(5, 0, 0));
  builder.add({{1, 0, 0}}, first);
  builder.add({{1, 0, 0}}, at(7));  // world (8, 0, 0)
  const auto map = builder.finish();
  ASSERT_TRUE(map);
  ASSERT_EQ(map->points.size(), 2U);
  EXPECT_LT((map->points[0] - Eigen::Vector3f(1, 0, 0)).norm(), 1e-6F);
  EXPECT_LT((map->points[1] - Eigen::Vector3f(0, -3, 0)).norm(), 1e-6F);
}

TEST(LocalMap, KeepsAtMostTwentyPointsAVoxel) {
  LocalMapBuilder builder{LocalMapOptions{}};
  Points points(50, Eigen::Vector3f(0.25F, 0.25F, 0.25F));
  points.resize(60, Eigen::Vector3f(-0.25F, 0.25F, 0.25F));
  builder.add(points, Pose());
  EXPECT_EQ(builder.finish()->points.size(), 30U);
}

TEST(Pcd, IsReadBackAsItWasWrittenAndRefusesACutOffFile) {
  const testing::TemporaryFolder folder;
  const Points points{{1, 2, 3}, {-4, 5.5F, 1e-3F}};
  write_pcd(folder / "a.pcd", points);
  EXPECT_EQ(read_pcd(folder / "a.pcd"), points);
  std::filesystem::resize_file(folder / "a.pcd", std::filesystem::file_size(folder / "a.pcd") - 4);
  EXPECT_ANY_THROW((void)read_pcd(folder / "a.pcd"));
}

}  // namespace
}  // namespace groundloop
