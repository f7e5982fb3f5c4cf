#include "backend/judging/robust.hpp"

#include <gtest/gtest.h>

#include "backend/judging/optimizer.hpp"
#include "tests/support/false_closures.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

constexpr int kLap = 600;

testing::SimulatedGraph drive() { return testing::simulate_graph(2400, 25, kLap, 7); }

OptimizerOptions robust() {
  OptimizerOptions options;
  options.robust = true;
  return options;
}

// Quantiles from tables of the chi-square distribution, 6 degrees of freedom.
TEST(ChiSquare, QuantilesAgreeWithTables) {
  EXPECT_NEAR(chi_square_quantile_6(0.5), 5.348, 5e-4);
  EXPECT_NEAR(chi_square_quantile_6(0.95), 12.592, 5e-4);
  EXPECT_NEAR(chi_square_quantile_6(0.99), 16.812, 5e-4);
}

struct Planting {
  const char* name;
  void (*plant)(testing::FalseClosures&, PoseGraph&);
};

class Planted : public ::testing::TestWithParam<Planting> {};

TEST_P(Planted, FalseClosuresLeaveTheTrajectoryWhatItWas) {
  const testing::SimulatedGraph simulated = drive();
  PoseGraph clean = simulated.graph;
  optimize(clean, {});
  const double clean_rmse = testing::position_rmse(clean, simulated.truth);
  PoseGraph graph = simulated.graph;
  testing::FalseClosures planted(simulated.truth, testing::closure_covariance().inverse(), 3);
  GetParam().plant(planted, graph);
  optimize(graph, robust());
  EXPECT_LT(testing::position_rmse(graph, simulated.truth), 1.03 * clean_rmse);
  const testing::Verdicts verdicts = testing::count_verdicts(graph, simulated.graph.edges.size());
  EXPECT_EQ(verdicts.false_kept, 0);
  EXPECT_LE(verdicts.true_rejected, 1);
  for (const GraphEdge& edge : graph.edges) EXPECT_EQ(edge.weight, edge.rejected ? 0.0 : 1.0);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Planted,
    ::testing::Values(
        Planting{"None", [](testing::FalseClosures&, PoseGraph&) {}},
        Planting{"Random",
                 [](testing::FalseClosures& f, PoseGraph& g) { f.add_random(g, 50, 50); }},
        Planting{"GroupsThatAgree",
                 [](testing::FalseClosures& f, PoseGraph& g) { f.add_groups(g, 8, 5, 10, 100); }},
        Planting{"FewMetresOff",
                 [](testing::FalseClosures& f, PoseGraph& g) { f.add_near(g, 40, 1, 1, kLap); }},
        Planting{"GroupsFewMetresOff",
                 [](testing::FalseClosures& f, PoseGraph& g) { f.add_near(g, 8, 5, 10, kLap); }}),
    [](const auto& planting) { return planting.param.name; });

TEST(Robust, JudgesPartsThatOnlyClosuresJoin) {
  // Two drives of the same way; three true closures between them, two false.
  testing::SimulatedGraph a = testing::simulate_graph(200, 0, 150, 1);
  const testing::SimulatedGraph b = testing::simulate_graph(200, 0, 150, 2);
  std::vector<Pose> truth = a.truth;
  truth.insert(truth.end(), b.truth.begin(), b.truth.end());
  for (GraphVertex vertex : b.graph.vertices) {
    vertex.id += 1000;
    a.graph.vertices.push_back(vertex);
  }
  for (GraphEdge edge : b.graph.edges) {
    edge.from += 200;
    edge.to += 200;
    a.graph.edges.push_back(edge);
  }
  for (const int i : {20, 60, 100, 140, 180}) {
    GraphEdge edge;
    edge.from = 200 + i;
    edge.to = i + 3;
    edge.kind = EdgeKind::closure;
    edge.T_from_to = b.truth[i].inverse() * a.truth[i + 3];
    if (i == 60 || i == 140) edge.T_from_to.translation.x() += 0.2 * i;
    edge.information = testing::closure_covariance().inverse();
    a.graph.edges.push_back(edge);
  }
  // The second drive starts at a wrong place.
  for (std::size_t i = 200; i < 400; ++i) a.graph.vertices[i].pose.translation.y() += 30.0;
  optimize(a.graph, robust());
  const std::size_t first = a.graph.edges.size() - 5;
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(a.graph.edges[first + k].rejected, k == 1 || k == 3) << k;
  }
  EXPECT_LT(testing::position_rmse(a.graph, truth), 1.0);
}

TEST(Robust, TwoSolvesGiveEqualBytes) {
  const testing::SimulatedGraph simulated = drive();
  PoseGraph graph = simulated.graph;
  testing::FalseClosures(simulated.truth, testing::closure_covariance().inverse(), 4)
      .add_random(graph, 25, 50);
  PoseGraph again = graph;
  optimize(graph, robust());
  optimize(again, robust());
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    EXPECT_EQ(graph.vertices[i].pose.translation, again.vertices[i].pose.translation);
    EXPECT_EQ(graph.vertices[i].pose.rotation.coeffs(), again.vertices[i].pose.rotation.coeffs());
  }
}

TEST(Robust, RejectsAllWhereAllAreFalseAndKeepsTheOdometry) {
  testing::SimulatedGraph simulated = testing::simulate_graph(1000, 0, 900, 5);
  PoseGraph graph = simulated.graph;
  testing::FalseClosures(simulated.truth, testing::closure_covariance().inverse(), 6)
      .add_random(graph, 20, 100);
  const double before = testing::position_rmse(graph, simulated.truth);
  const OptimizationSummary summary = optimize(graph, robust());
  EXPECT_EQ(summary.rejected_edges.size(), 20u);
  EXPECT_NEAR(testing::position_rmse(graph, simulated.truth), before, 1e-6);
}

}  // namespace
}  // namespace groundloop
