#include "backend/mapping/scan_uncertainty.hpp"

#include <gtest/gtest.h>

#include "backend/graph/marginals.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

constexpr int kMaps = 8;
constexpr int kScansOfAMap = 25;
constexpr double kScale = 3.0;  // of the odometry, over what the drift model says

// Two maps short of a lap and a half, its graph as a run writes it: ways composed, one closure.
StoredSession session() {
  StoredSession result{SessionFolder("nowhere"), {}, {}, {}};
  SessionPart part;
  std::vector<Pose> way;
  for (int i = 0; i < kMaps * kScansOfAMap; ++i) {
    way.push_back(testing::circuit_pose(4.0 * i, 550.0));
    part.trajectory.push_back({100LL * i, way.back()});
  }
  part.odometry = part.trajectory;
  for (int m = 0; m < kMaps; ++m) {
    const auto first = static_cast<std::size_t>(m * kScansOfAMap);
    part.maps.push_back({m, first, first + kScansOfAMap - 1, 1, way[first]});
    result.graph.vertices.push_back({m, way[first], m == 0});
    if (m == 0) continue;
    const RelativePose step =
        compose_odometry(way, first - kScansOfAMap, first, scaled({}, kScale));
    result.graph.edges.push_back(
        {m - 1, m, step.T_from_to, step.covariance.inverse(), EdgeKind::odometry});
  }
  const Pose T_closure = result.graph.vertices[6].pose.inverse() * result.graph.vertices[0].pose;
  result.graph.edges.push_back(
      {6, 0, T_closure, testing::closure_covariance().inverse(), EdgeKind::closure});
  result.parts.push_back(std::move(part));
  return result;
}

TEST(GraphOfScans, KnowsTheMapsAsTheSessionsGraphDoes) {
  const StoredSession stored = session();
  const std::vector<Matrix6d> of_maps = pose_covariances(stored.graph).value();
  const PoseGraph scans = graph_of_scans(stored, {});
  ASSERT_EQ(scans.vertices.size(), static_cast<std::size_t>(kMaps * kScansOfAMap));
  const std::vector<Matrix6d> of_scans = pose_covariances(scans).value();
  for (int m = 0; m < kMaps; ++m) {
    const Matrix6d& expected = of_maps[static_cast<std::size_t>(m)];
    const Matrix6d& found = of_scans[static_cast<std::size_t>(m * kScansOfAMap)];
    EXPECT_LT((found - expected).norm(), 1e-3 * expected.norm() + 1e-12) << m;
  }
  // Inside a map that no closure follows, uncertainty grows; between closed maps it bulges.
  EXPECT_GT(of_scans.back()(0, 0) + of_scans.back()(1, 1),
            of_maps.back()(0, 0) + of_maps.back()(1, 1));
}

}  // namespace
}  // namespace groundloop
