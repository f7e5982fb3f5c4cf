#include "backend/judging/odometry_scale.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "backend/judging/closure_groups.hpp"
#include "frontend/core/error.hpp"
#include "tests/support/false_closures.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

constexpr int kLap = 600;

TEST(OdometryScale, IsOneWithoutClosures) {
  const testing::SimulatedGraph simulated = testing::simulate_graph(500, 0, 400, 3, 5.0);
  EXPECT_EQ(estimate_odometry_scale(simulated.graph).scale, 1.0);
}

TEST(OdometryScale, StaysNearOneWhereAllClosuresAreFalse) {
  testing::SimulatedGraph simulated = testing::simulate_graph(1000, 0, 900, 5);
  testing::FalseClosures(simulated.truth, testing::closure_covariance().inverse(), 6)
      .add_random(simulated.graph, 20, 100);
  const OdometryScale found = estimate_odometry_scale(simulated.graph);
  EXPECT_LT(found.scale, 2.0);
  EXPECT_EQ(found.trials[found.best].accepted, 0);
}

// Scales are tried at the same time.
TEST(OdometryScale, TellsProgressFromOneThreadAtATimeAndCanBeInterrupted) {
  const testing::SimulatedGraph simulated = testing::simulate_graph(1200, 12, kLap, 8);
  std::atomic<int> inside = 0;
  int told = 0;
  const Progress count = [&](const std::string&, std::size_t, std::size_t) {
    EXPECT_EQ(++inside, 1);
    ++told;
    --inside;
  };
  const double scale = estimate_odometry_scale(simulated.graph, {}, count).scale;
  EXPECT_GT(told, 11);
  EXPECT_EQ(scale, estimate_odometry_scale(simulated.graph).scale);
  const Progress stop = [&](const std::string&, std::size_t, std::size_t) {
    if (--told == 0) throw Interrupted();
  };
  EXPECT_THROW((void)estimate_odometry_scale(simulated.graph, {}, stop), Interrupted);
}

TEST(OdometryScale, OneTrueClosureTellsOfWorseOdometry) {
  // Odometry errs four times as much as it says; nothing but one closure tells.
  testing::SimulatedGraph simulated = testing::simulate_graph(800, 0, 600, 8, 4.0);
  GraphEdge closure;
  closure.from = 700;
  closure.to = 100;
  closure.kind = EdgeKind::closure;
  closure.T_from_to = simulated.truth[700].inverse() * simulated.truth[100];
  closure.information = testing::closure_covariance().inverse();
  simulated.graph.edges.push_back(closure);
  const OdometryScale found = estimate_odometry_scale(simulated.graph);
  EXPECT_GT(found.scale, 1.9);
  EXPECT_EQ(found.trials[found.best].accepted, 1);
}

TEST(OdometryScale, AStepOfUnknownErrorDoesNotHideWhatTheClosuresSay) {
  testing::SimulatedGraph simulated = testing::simulate_graph(1200, 12, kLap, 8);
  const double known = estimate_odometry_scale(simulated.graph).scale;
  simulated.graph.edges[300].information.setZero();
  const OdometryScale found = estimate_odometry_scale(simulated.graph);
  EXPECT_TRUE(std::isfinite(found.trials[found.best].log_evidence));
  EXPECT_NEAR(found.scale, known, 0.5 * known);
  EXPECT_GT(found.scale, 0.6);
}

TEST(OdometryScale, IsTheStatedOneWhereNoTrialSaysAnything) {
  testing::SimulatedGraph simulated = testing::simulate_graph(1200, 12, kLap, 8);
  // A closure whose pose is no number has no evidence at any scale.
  for (GraphEdge& edge : simulated.graph.edges) {
    if (edge.kind == EdgeKind::closure) edge.information.setConstant(std::nan(""));
  }
  EXPECT_EQ(estimate_odometry_scale(simulated.graph).scale, 1.0);
}

TEST(ClosureGroups, NeighboursThatAgreeAreOneGroup) {
  testing::SimulatedGraph simulated = testing::simulate_graph(2400, 0, kLap, 7);
  const std::size_t first = simulated.graph.edges.size();
  testing::FalseClosures planted(simulated.truth, testing::closure_covariance().inverse(), 7);
  planted.add_near(simulated.graph, 1, 5, 10, kLap);
  planted.add_near(simulated.graph, 1, 1, 1, kLap);
  std::vector<std::size_t> closures;
  for (std::size_t k = first; k < simulated.graph.edges.size(); ++k) closures.push_back(k);
  const ClosureGroups groups = group_closures(simulated.graph, OdometryTree(simulated.graph),
                                              closures, 50.0, chi_square_quantile_6(0.99));
  ASSERT_EQ(groups.groups.size(), 2u);
  EXPECT_EQ(groups.groups[0].size(), 5u);
  EXPECT_EQ(groups.groups[1], std::vector<std::size_t>{first + 5});
  EXPECT_EQ(groups.inner_log_density[1], 0.0);
}

TEST(ClosureGroups, LogDensityIsThatOfTheNormalDistribution) {
  // Six independent numbers of deviation 2, one of them 2: -6 ln 2 - 3 ln(2 pi) - 1/2.
  RelativePose loop;
  loop.T_from_to.translation.x() = 2.0;
  loop.covariance = 4.0 * Matrix6d::Identity();
  EXPECT_NEAR(log_density(loop), -6.0 * std::log(2.0) - 3.0 * std::log(2.0 * M_PI) - 0.5, 1e-12);
}

}  // namespace
}  // namespace groundloop
