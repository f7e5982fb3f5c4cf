#include "backend/judging/optimizer.hpp"

#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "backend/graph/g2o_file.hpp"
#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

GraphEdge edge_between(int from, int to, const Pose& T_from_to) {
  GraphEdge edge;
  edge.from = from;
  edge.to = to;
  edge.T_from_to = T_from_to;
  edge.information.diagonal() << 100, 100, 50, 400, 400, 900;
  return edge;
}

// A helix of `n` poses with exact odometry and exact closures of one turn; the guess is off.
PoseGraph helix(int n, double guess_error) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  PoseGraph graph;
  std::vector<Pose> truth;
  for (int i = 0; i < n; ++i) {
    const double angle = 0.3 * i;
    truth.emplace_back(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
                       Eigen::Vector3d(10 * std::cos(angle) - 10, 10 * std::sin(angle), 0.1 * i));
  }
  for (int i = 0; i < n; ++i) {
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = i == 0 ? 0.0 : guess_error * uniform(generator);
    graph.vertices.push_back({i, truth[i] * exp_se3(error), false});
    if (i > 0) graph.edges.push_back(edge_between(i - 1, i, truth[i - 1].inverse() * truth[i]));
    if (i >= 21) graph.edges.push_back(edge_between(i, i - 21, truth[i].inverse() * truth[i - 21]));
  }
  return graph;
}

class Initialisation : public ::testing::TestWithParam<const char*> {};

TEST_P(Initialisation, FindsPosesThatAgreeWithAllMeasurements) {
  PoseGraph graph = helix(100, 0.2);
  const PoseGraph truth = helix(100, 0.0);
  OptimizerOptions options;
  options.initialisation = GetParam();
  const OptimizationSummary summary = optimize(graph, options);
  EXPECT_TRUE(summary.converged);
  EXPECT_GT(summary.cost_before, 1.0);
  EXPECT_LT(summary.cost_after, 1e-12);
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    const Pose error = truth.vertices[i].pose.inverse() * graph.vertices[i].pose;
    EXPECT_LT(log_se3(error).norm(), 1e-6) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Starts, Initialisation, ::testing::Values("auto", "guess", "chordal"));

TEST(Optimize, TwoSolvesGiveEqualBytes) {
  PoseGraph a = helix(200, 0.3);
  PoseGraph b = helix(200, 0.3);
  optimize(a, {});
  optimize(b, {});
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    EXPECT_EQ(a.vertices[i].pose.translation, b.vertices[i].pose.translation);
    EXPECT_EQ(a.vertices[i].pose.rotation.coeffs(), b.vertices[i].pose.rotation.coeffs());
  }
}

TEST(Optimize, AveragesRepeatedEdgesByInformation) {
  PoseGraph graph;
  graph.vertices = {{0, Pose(), false}, {1, Pose(), false}};
  Pose one, two;
  one.translation.x() = 1.0;
  two.translation.x() = 2.0;
  graph.edges = {edge_between(0, 1, one), edge_between(0, 1, two)};
  graph.edges[1].information *= 3.0;
  const OptimizationSummary summary = optimize(graph, {});
  EXPECT_NEAR(graph.vertices[1].pose.translation.x(), 1.75, 1e-9);
  // 1/2 (100 * 0.75^2 + 300 * 0.25^2)
  EXPECT_NEAR(summary.cost_after, 37.5, 1e-6);
}

TEST(Optimize, HoldsTheFirstVertexOfEachComponentOrTheFixedOnes) {
  PoseGraph graph;
  for (int i = 0; i < 4; ++i) {
    Pose pose;
    pose.translation.x() = 10.0 * i;
    graph.vertices.push_back({i, pose, i == 3});
  }
  Pose step;
  step.translation.x() = 1.0;
  graph.edges = {edge_between(0, 1, step), edge_between(2, 3, step)};
  const OptimizationSummary summary = optimize(graph, {});
  EXPECT_EQ(summary.components, 2);
  EXPECT_NEAR(graph.vertices[0].pose.translation.x(), 0.0, 1e-12);
  EXPECT_NEAR(graph.vertices[1].pose.translation.x(), 1.0, 1e-9);
  EXPECT_NEAR(graph.vertices[2].pose.translation.x(), 29.0, 1e-9);
  EXPECT_NEAR(graph.vertices[3].pose.translation.x(), 30.0, 1e-12);
}

TEST(Optimize, AcceptsGraphsWithNothingToDo) {
  PoseGraph empty;
  EXPECT_EQ(optimize(empty, {}).cost_after, 0.0);
  PoseGraph lone;
  lone.vertices = {{3, Pose(), false}};
  EXPECT_EQ(optimize(lone, {}).components, 1);
}

TEST(Optimize, AcceptsInformationThatLeavesADirectionFree) {
  PoseGraph graph = helix(50, 0.1);
  graph.edges[20].information(2, 2) = 0.0;
  EXPECT_LT(optimize(graph, {}).cost_after, 1e-10);
}

TEST(Optimize, RefusesInformationThatIsNotPositiveSemiDefinite) {
  PoseGraph graph = helix(10, 0.1);
  graph.edges[3].information(0, 0) = -5.0;
  EXPECT_THROW(optimize(graph, {}), InputError);
}

TEST(Optimize, RefusesAnUnknownInitialisation) {
  PoseGraph graph = helix(10, 0.1);
  OptimizerOptions options;
  options.initialisation = "magic";
  EXPECT_THROW(optimize(graph, options), InputError);
}

// Costs of tests' public graphs as published beside them (GTSAM from a chordal start).
struct PublishedOptimum {
  const char* name;
  double cost;
};

class PublicGraph : public ::testing::TestWithParam<PublishedOptimum> {};

TEST_P(PublicGraph, ReachesThePublishedCostFromTheFilesGuess) {
  const std::filesystem::path file = std::filesystem::path(GROUNDLOOP_SHARED_DATA) / "pose_graphs" /
                                     (std::string(GetParam().name) + ".g2o");
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "needs the public pose graph " << file.string();
  }
  PoseGraph graph = read_g2o(file).graph;
  const OptimizationSummary summary = optimize(graph, {});
  EXPECT_LT(summary.cost_after, 1.001 * GetParam().cost);
  EXPECT_TRUE(summary.converged) << summary.termination;
}

INSTANTIATE_TEST_SUITE_P(Files, PublicGraph,
                         ::testing::Values(PublishedOptimum{"torus3D", 12119.5},
                                           PublishedOptimum{"sphere2500", 675.742},
                                           PublishedOptimum{"parking-garage", 0.634193},
                                           PublishedOptimum{"sphere_bignoise_vertex3", 1.49452e6}),
                         [](const auto& graph) {
                           std::string name = graph.param.name;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace groundloop
