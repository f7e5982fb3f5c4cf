// Condensed graphs: what is kept, and that solving by way of them is solving the whole graph.
#include "backend/graph/chains.hpp"

#include <gtest/gtest.h>

#include "backend/graph/factors.hpp"
#include "backend/graph/vertical_factor.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

constexpr int kLap = 600;

testing::SimulatedGraph drive() { return testing::simulate_graph(2400, 25, kLap, 7); }

TEST(CondenseChains, KeepsWhereClosuresMeet) {
  const testing::SimulatedGraph simulated = drive();
  const CondensedGraph condensed = condense_chains(simulated.graph);
  EXPECT_LE(condensed.graph.vertices.size(), 2u * 25u + 2u);
  EXPECT_EQ(condensed.graph.edges.size(), condensed.edge_of.size());
  for (std::size_t i = 0; i < condensed.kept.size(); ++i)
    EXPECT_EQ(condensed.graph.vertices[i].id, simulated.graph.vertices[condensed.kept[i]].id);
  std::size_t edges = 0;
  for (const auto& run : condensed.runs) edges += run.size();
  EXPECT_LE(edges, simulated.graph.edges.size());
}

TEST(CondenseChains, FollowsEdgesAgainstTheirDirection) {
  PoseGraph graph;
  for (int i = 0; i < 4; ++i) graph.vertices.push_back({i, Pose(), false});
  Pose step;
  step.translation.x() = 1.0;
  for (const auto& [from, to] : {std::pair(0, 1), std::pair(2, 1), std::pair(2, 3)}) {
    GraphEdge edge;
    edge.from = from;
    edge.to = to;
    edge.T_from_to = from < to ? step : step.inverse();
    graph.edges.push_back(edge);
  }
  const CondensedGraph condensed = condense_chains(graph);
  ASSERT_EQ(condensed.graph.edges.size(), 1u);
  EXPECT_EQ(condensed.kept[condensed.graph.edges[0].from], 0);
  EXPECT_EQ(condensed.kept[condensed.graph.edges[0].to], 3);
  EXPECT_NEAR(condensed.graph.edges[0].T_from_to.translation.x(), 3.0, 1e-12);
  EXPECT_NEAR(condensed.graph.edges[0].information(0, 0), 1.0 / 3.0, 1e-9);
}

// The drive with verticals, and a bend that its odometry was made with.
PoseGraph bent_drive(Bend bend) {
  testing::SimulatedGraph simulated = drive();
  PoseGraph& graph = simulated.graph;
  graph.bends = {Bend::Zero()};
  graph.bend_priors = {{0, Bend(1e-4, 1e-4)}};
  graph.ups = {Eigen::Vector3d::UnitZ()};
  for (GraphEdge& edge : graph.edges) {
    if (edge.kind != EdgeKind::odometry) continue;
    edge.bend = 0;
    const Eigen::Vector3d step = edge.T_from_to.translation;
    edge.error_by_bend.col(0).tail<3>() = Eigen::Vector3d::UnitZ().cross(step);
    edge.error_by_bend.col(1)(5) = step.norm();
    edge.T_from_to = edge.T_from_to * exp_se3(edge.error_by_bend * bend);
  }
  for (int i = 50; i < 2400; i += 100) {
    graph.verticals.push_back(
        vertical_factor(i, 0, simulated.truth[i].rotation.conjugate() * Eigen::Vector3d::UnitZ(),
                        1e-5 * Eigen::Matrix2d::Identity()));
  }
  for (int i = 1; i < 2400; ++i)
    graph.vertices[i].pose = graph.vertices[i - 1].pose * graph.edges[i - 1].T_from_to;
  return graph;
}

TEST(SolveCondensed, EndsWhereTheWholeGraphIsSolved) {
  const PoseGraph start = bent_drive(Bend(8e-5, -5e-5));
  PoseGraph whole = start;
  solve(whole, gauge(whole), {200, 1e-12});
  PoseGraph condensed = start;
  const SolveReport report = solve_condensed(condensed, gauge(condensed), {200, 1e-12});
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(cost(condensed), cost(whole), 1e-6 * cost(whole));
  for (std::size_t i = 0; i < whole.vertices.size(); ++i) {
    const Pose between = whole.vertices[i].pose.inverse() * condensed.vertices[i].pose;
    ASSERT_LT(log_se3(between).norm(), 1e-4) << i;
  }
  EXPECT_LT((whole.bends[0] - condensed.bends[0]).norm(), 1e-9);
  EXPECT_LT((whole.ups[0] - condensed.ups[0]).norm(), 1e-6);
  // The bend that the odometry was made with is found from closures and verticals.
  EXPECT_LT((whole.bends[0] - Bend(8e-5, -5e-5)).norm(), 2e-5);
}

TEST(SolveCondensed, AStepOfTheCondensedGraphIsOneOfTheWhole) {
  // Away from odometry, too, the condensed normal equations are those of the whole graph with the
  // inner poses eliminated: at the solution nothing moves.
  PoseGraph graph = bent_drive(Bend(8e-5, -5e-5));
  solve(graph, gauge(graph), {200, 1e-13});
  CondensedGraph condensed = condense_chains(graph);
  const PoseGraph before = condensed.graph;
  solve(condensed.graph, gauge(condensed.graph), {1, 0.0});
  EXPECT_NEAR(cost(before), cost(graph), 1e-6 * cost(graph));
  for (std::size_t i = 0; i < before.vertices.size(); ++i) {
    const Pose moved = before.vertices[i].pose.inverse() * condensed.graph.vertices[i].pose;
    EXPECT_LT(log_se3(moved).norm(), 1e-5) << i;
  }
}

}  // namespace
}  // namespace groundloop
