// Solving a graph with Ceres: that what it lowers is the cost of the factors.
#include "backend/graph/solver.hpp"

#include <random>

#include <gtest/gtest.h>

#include "backend/graph/factors.hpp"
#include "backend/graph/vertical_factor.hpp"

namespace groundloop {
namespace {

Matrix6d uneven_information(std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Matrix6d m;
  for (int i = 0; i < 36; ++i) m(i) = uniform(generator);
  const Vector6d scale = (Vector6d() << 1, 300, 0.1, 20, 3000, 5).finished();
  return scale.asDiagonal() * (m * m.transpose() + 0.1 * Matrix6d::Identity()).eval() *
         scale.asDiagonal();
}

Vector6d random_twist(std::mt19937& generator, double size) {
  std::normal_distribution<double> normal(0.0, size);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = normal(generator);
  return xi;
}

// A ring of ten poses with an edge across, one vertical, a bend and a prior: every kind of factor.
PoseGraph ring(unsigned seed) {
  std::mt19937 generator(seed);
  PoseGraph graph;
  graph.bends = {Bend::Zero()};
  graph.bend_priors = {{0, Bend(0.01, 0.02)}};
  graph.ups = {Eigen::Vector3d::UnitZ()};
  for (int i = 0; i < 10; ++i) graph.vertices.push_back({i, exp_se3(random_twist(generator, 0.8))});
  for (int i = 0; i < 11; ++i) {
    GraphEdge edge;
    edge.from = i < 10 ? i : 2;
    edge.to = i < 10 ? (i + 1) % 10 : 7;
    edge.kind = i < 9 ? EdgeKind::odometry : EdgeKind::closure;
    edge.T_from_to = graph.vertices[edge.from].pose.inverse() * graph.vertices[edge.to].pose *
                     exp_se3(random_twist(generator, 0.05));
    edge.information = uneven_information(generator);
    if (i < 9) {
      edge.bend = 0;
      edge.error_by_bend.col(0) = random_twist(generator, 1.0);
      edge.error_by_bend.col(1) = random_twist(generator, 1.0);
    }
    if (i == 10) edge.weight = 0.3;
    graph.edges.push_back(edge);
  }
  graph.verticals = {vertical_factor(4, 0, Eigen::Vector3d(0.1, -0.2, 1.0).normalized(),
                                     Eigen::Vector2d(0.01, 0.3).asDiagonal())};
  graph.priors = {{3, graph.vertices[3].pose * exp_se3(random_twist(generator, 0.05)),
                   uneven_information(generator)}};
  return graph;
}

TEST(Solve, ReportsTheCostOfTheFactors) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    PoseGraph graph = ring(seed);
    const double before = cost(graph);
    const SolveReport report = solve(graph, gauge(graph), {200, 1e-12});
    EXPECT_TRUE(report.converged) << report.termination;
    EXPECT_LT(report.cost, before);
    EXPECT_NEAR(report.cost, cost(graph), 1e-9 * before) << "seed " << seed;
  }
}

TEST(Solve, EndsWhereNoSmallMoveOfAnyVariableCostsLess) {
  PoseGraph graph = ring(1);
  solve(graph, gauge(graph), {200, 1e-15});
  const double least = cost(graph);
  const double h = 1e-5;
  for (int v = 0; v <= bend_variable(graph, 0); ++v) {
    for (int i = 0; i < size_of_variable(graph, v); ++i) {
      for (const double step : {-h, h}) {
        PoseGraph moved = graph;
        perturb(moved, v, step * Vector6d::Unit(i));
        EXPECT_GE(cost(moved), least) << "variable " << v << ", direction " << i;
      }
    }
  }
}

TEST(Solve, LeavesWhatIsHeldAndWhatWasRejected) {
  PoseGraph graph = ring(2);
  graph.priors.clear();
  graph.edges.back().rejected = true;
  graph.edges.back().T_from_to.translation.x() += 100.0;
  PoseGraph without = graph;
  without.edges.pop_back();
  const std::vector<char> held = gauge(graph);
  const PoseGraph before = graph;
  const double with_rejected = solve(graph, held, {200, 1e-12}).cost;
  EXPECT_NEAR(with_rejected, solve(without, held, {200, 1e-12}).cost, 1e-9 * with_rejected);
  EXPECT_EQ(graph.vertices[0].pose.translation, before.vertices[0].pose.translation);
}

}  // namespace
}  // namespace groundloop
