#include "apps/report/point_octree.hpp"

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

namespace groundloop::apps {
namespace {

// A level square of points half a metre apart, each with a row of its own.
std::vector<MapPoint> square(int side) {
  std::vector<MapPoint> points;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      MapPoint p;
      p.position = {0.5F * static_cast<float>(x) + 0.25F, 0.5F * static_cast<float>(y) + 0.25F,
                    0.25F};
      p.row = static_cast<std::uint32_t>(points.size());
      points.push_back(p);
    }
  }
  return points;
}

TEST(PointOctree, HoldsEveryPointOnceAndLevelsHalveTheSpacing) {
  const std::vector<MapPoint> points = square(300);
  const PointOctree tree = build_octree(points, 0.5F, points.size());
  ASSERT_EQ(tree.points.size(), points.size());
  std::set<std::uint32_t> rows;
  for (const MapPoint& p : tree.points) rows.insert(p.row);
  EXPECT_EQ(rows.size(), points.size());
  EXPECT_FLOAT_EQ(tree.spacing(tree.levels - 1), 0.5F);
  for (int level = 1; level < tree.levels; ++level)
    EXPECT_FLOAT_EQ(tree.spacing(level), 0.5F * tree.spacing(level - 1));
  // A level has a quarter of the points of the next where points lie in a plane; the coarsest is
  // where another halving would be worth nothing.
  std::map<int, std::size_t> up_to;
  for (const OctreeNode& node : tree.nodes) {
    for (int level = node.level; level < tree.levels; ++level) up_to[level] += node.count;
  }
  EXPECT_LE(up_to[0], 4096U);
  for (int level = 1; level < tree.levels; ++level)
    EXPECT_NEAR(static_cast<double>(up_to[level]) / static_cast<double>(up_to[level - 1]), 4.0,
                0.3);
}

TEST(PointOctree, NodesFollowOneAnotherAndHoldTheirPoints) {
  const PointOctree tree = build_octree(square(200), 0.5F, 40'000);
  std::size_t next = 0;
  int level = 0;
  for (const OctreeNode& node : tree.nodes) {
    EXPECT_EQ(node.first, next);
    EXPECT_GE(node.level, level);
    next += node.count;
    level = node.level;
    for (std::size_t i = node.first; i < next; ++i) {
      const Eigen::Vector3f inside = tree.points[i].position - node.corner;
      EXPECT_TRUE((inside.array() >= 0.0F).all() && (inside.array() <= node.edge).all());
    }
  }
  EXPECT_EQ(next, tree.points.size());
}

TEST(PointOctree, LeavesOutOfTheFinestLevelWhatThereIsNoRoomFor) {
  const std::vector<MapPoint> points = square(300);
  const PointOctree whole = build_octree(points, 0.5F, points.size());
  const PointOctree thin = build_octree(points, 0.5F, 60'000);
  EXPECT_EQ(thin.points.size(), 60'000U);
  ASSERT_EQ(thin.levels, whole.levels);
  const auto coarser = [](const PointOctree& tree) {
    std::size_t n = 0;
    for (const OctreeNode& node : tree.nodes) n += node.level + 1 < tree.levels ? node.count : 0;
    return n;
  };
  EXPECT_EQ(coarser(thin), coarser(whole));
}

TEST(PointOctree, OfNoPointsIsEmpty) {
  const PointOctree tree = build_octree({}, 0.5F, 10);
  EXPECT_EQ(tree.levels, 0);
  EXPECT_TRUE(tree.nodes.empty());
}

TEST(PointSampler, KeepsMeasuredPointsOneAVoxelAndNoMoreThanTwiceTheWanted) {
  PointSampler sampler(1000, 0.1F);
  std::set<std::tuple<float, float, float>> measured;
  for (const MapPoint& p : square(100)) {
    sampler.add(p);
    measured.insert({p.position.x(), p.position.y(), p.position.z()});
  }
  EXPECT_LE(sampler.points().size(), 2000U);
  EXPECT_GT(sampler.points().size(), 500U);
  std::set<std::tuple<int, int, int>> voxels;
  for (const MapPoint& p : sampler.points()) {
    EXPECT_TRUE(measured.contains({p.position.x(), p.position.y(), p.position.z()}));
    const auto cell = [&](int axis) {
      return static_cast<int>(std::floor(p.position[axis] * (1.0F / sampler.voxel_size())));
    };
    EXPECT_TRUE(voxels.insert({cell(0), cell(1), cell(2)}).second);
  }
}

TEST(PointSampler, LeavesOutWhatIsNoPlace) {
  PointSampler sampler(10);
  sampler.add({{NAN, 0.0F, 0.0F}, 0});
  sampler.add({{INFINITY, 0.0F, 0.0F}, 0});
  EXPECT_TRUE(sampler.points().empty());
}

}  // namespace
}  // namespace groundloop::apps
