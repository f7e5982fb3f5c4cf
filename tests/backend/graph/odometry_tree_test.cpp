#include "backend/graph/odometry_tree.hpp"

#include <gtest/gtest.h>

#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

TEST(OdometryTree, AgreesWithCompositionAlongTheChain) {
  testing::SimulatedGraph simulated = testing::simulate_graph(300, 10, 200, 1);
  PoseGraph& graph = simulated.graph;
  const OdometryTree tree(graph);
  for (const auto& [from, to] : {std::pair(0, 299), std::pair(120, 160), std::pair(200, 30)}) {
    RelativePose chain;
    for (int i = std::min(from, to); i < std::max(from, to); ++i) {
      const GraphEdge& edge = graph.edges[i];
      chain = chain * RelativePose{edge.T_from_to, edge.information.inverse()};
    }
    if (from > to) chain = inverse(chain);
    const RelativePose result = tree.between(from, to);
    EXPECT_LT(log_se3(chain.T_from_to.inverse() * result.T_from_to).norm(), 1e-9);
    EXPECT_LT((chain.covariance - result.covariance).norm(), 1e-6 * chain.covariance.norm());
  }
}

// A fork: 1 -> 0, 1 -> 2, 1 -> 3 -> 4, rooted at 0.
TEST(OdometryTree, GoesUpAndDownWhereTheWayForks) {
  PoseGraph graph;
  for (int i = 0; i < 5; ++i) graph.vertices.push_back({i, Pose(), false});
  for (const auto& [from, to] :
       {std::pair(1, 0), std::pair(1, 2), std::pair(1, 3), std::pair(3, 4)}) {
    GraphEdge edge;
    edge.from = from;
    edge.to = to;
    edge.T_from_to = exp_se3(0.3 * Vector6d::LinSpaced(from - 1.0, to + 1.0));
    edge.information = (1.0 + to) * Matrix6d::Identity();
    graph.edges.push_back(edge);
  }
  const OdometryTree tree(graph);
  const auto edge = [&](std::size_t k) {
    return RelativePose{graph.edges[k].T_from_to, graph.edges[k].information.inverse()};
  };
  const RelativePose expected = inverse(edge(1)) * edge(2) * edge(3);
  const RelativePose result = tree.between(2, 4);
  EXPECT_LT(log_se3(expected.T_from_to.inverse() * result.T_from_to).norm(), 1e-12);
  EXPECT_LT((expected.covariance - result.covariance).norm(), 1e-9);
}

TEST(OdometryTree, ConcludesNothingBetweenParts) {
  PoseGraph graph;
  for (int i = 0; i < 2; ++i) graph.vertices.push_back({i, Pose(), false});
  const OdometryTree tree(graph);
  EXPECT_GT(tree.between(0, 1).covariance(0, 0), 1e9);
}

}  // namespace
}  // namespace groundloop
