#include "backend/graph/pose_graph.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

Vector6d random_twist(std::mt19937& generator, double translation, double rotation) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? translation : rotation) * uniform(generator);
  return xi;
}

Matrix6d random_information(std::mt19937& generator) {
  Matrix6d m;
  for (int i = 0; i < 6; ++i) m.col(i) = random_twist(generator, 3.0, 3.0);
  return m * m.transpose() + 0.1 * Matrix6d::Identity();
}

PoseGraph two_poses() {
  PoseGraph graph;
  graph.vertices = {{4, Pose(), false}, {9, Pose(), false}};
  GraphEdge edge;
  edge.from = 4;
  edge.to = 9;
  graph.edges = {edge};
  return graph;
}

std::string message_of(const PoseGraph& graph) {
  try {
    (void)resolve_edges(graph);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(BetweenResidual, IsZeroWhereTheMeasurementHolds) {
  std::mt19937 generator(1);
  const Pose a = exp_se3(random_twist(generator, 10.0, 1.5));
  const Pose b = exp_se3(random_twist(generator, 10.0, 1.5));
  EXPECT_LT(between_residual(a, b, a.inverse() * b).norm(), 1e-12);
}

TEST(BetweenResidual, JacobiansAgreeWithFiniteDifferences) {
  std::mt19937 generator(2);
  for (int trial = 0; trial < 100; ++trial) {
    // Residuals from nearly zero to beyond two radians.
    const double size = trial % 4 == 0 ? 1e-6 : 0.4 * (trial % 4);
    const Pose from = exp_se3(random_twist(generator, 10.0, 1.5));
    const Pose measured = exp_se3(random_twist(generator, 10.0, 1.0));
    const Pose to = from * measured * exp_se3(random_twist(generator, 5.0 * size, size));
    Matrix6d J_from, J_to;
    const Vector6d r = between_residual(from, to, measured, J_from, J_to);
    EXPECT_LT((r - between_residual(from, to, measured)).norm(), 1e-14);
    const double h = 1e-6;
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = h * Vector6d::Unit(i);
      const Vector6d from_numeric = (between_residual(from * exp_se3(d), to, measured) -
                                     between_residual(from * exp_se3(-d), to, measured)) /
                                    (2 * h);
      const Vector6d to_numeric = (between_residual(from, to * exp_se3(d), measured) -
                                   between_residual(from, to * exp_se3(-d), measured)) /
                                  (2 * h);
      EXPECT_LT((J_from.col(i) - from_numeric).norm(), 1e-6) << "trial " << trial;
      EXPECT_LT((J_to.col(i) - to_numeric).norm(), 1e-6) << "trial " << trial;
    }
  }
}

TEST(Whitening, SquaresToTheInformationOfAFullMatrix) {
  std::mt19937 generator(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix6d information = random_information(generator);
    const Vector6d r = random_twist(generator, 2.0, 0.5);
    const double expected = r.dot(information * r);
    EXPECT_NEAR((whitening(information) * r).squaredNorm(), expected, 1e-10 * expected);
  }
}

TEST(Whitening, SquaresToSingularInformation) {
  std::mt19937 generator(4);
  const Vector6d a = random_twist(generator, 1.0, 1.0);
  const Vector6d b = random_twist(generator, 1.0, 1.0);
  const Matrix6d information = a * a.transpose() + b * b.transpose();
  const Matrix6d W = whitening(information);
  EXPECT_LT((W.transpose() * W - information).norm(), 1e-12);
}

TEST(Cost, IsHalfTheSquaredMahalanobisNormOfTheLogarithm) {
  std::mt19937 generator(5);
  PoseGraph graph = two_poses();
  const Vector6d r = random_twist(generator, 2.0, 0.6);
  graph.edges[0].T_from_to = exp_se3(random_twist(generator, 3.0, 1.0));
  graph.edges[0].information = random_information(generator);
  graph.vertices[0].pose = exp_se3(random_twist(generator, 3.0, 1.0));
  graph.vertices[1].pose = graph.vertices[0].pose * graph.edges[0].T_from_to * exp_se3(r);
  const double expected = 0.5 * r.dot(graph.edges[0].information * r);
  EXPECT_NEAR(cost(graph), expected, 1e-9 * expected);
  graph.edges[0].weight = 0.25;
  EXPECT_NEAR(cost(graph), 0.25 * expected, 1e-9 * expected);
  graph.edges[0].rejected = true;
  EXPECT_EQ(cost(graph), 0.0);
}

TEST(Chi2G2o, UsesTranslationAndQuaternionVector) {
  PoseGraph graph = two_poses();
  graph.edges[0].information = Vector6d(1, 2, 3, 4, 5, 6).asDiagonal();
  graph.vertices[1].pose =
      Pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ())), {1, 2, 3});
  const double s = std::sin(0.2);
  EXPECT_NEAR(chi2_g2o(graph), 1 + 2 * 4 + 3 * 9 + 6 * s * s, 1e-12);
}

TEST(ResolveEdges, NamesWhatIsWrong) {
  EXPECT_EQ(message_of(two_poses()), "");
  PoseGraph graph = two_poses();
  graph.edges[0].to = 7;
  EXPECT_NE(message_of(graph).find("names vertex 7"), std::string::npos);
  graph = two_poses();
  graph.edges[0].to = 4;
  EXPECT_NE(message_of(graph).find("itself"), std::string::npos);
  graph = two_poses();
  graph.edges[0].information(2, 2) = -1.0;
  EXPECT_NE(message_of(graph).find("edge 0 (4 to 9) has information that is not positive"),
            std::string::npos);
  graph = two_poses();
  graph.edges[0].information(0, 1) = 0.5;
  EXPECT_NE(message_of(graph).find("not symmetric"), std::string::npos);
  graph = two_poses();
  graph.vertices[1].id = 4;
  EXPECT_NE(message_of(graph).find("vertex 4 occurs twice"), std::string::npos);
  graph = two_poses();
  graph.vertices[1].pose.translation.x() = NAN;
  EXPECT_NE(message_of(graph).find("vertex 9 is not finite"), std::string::npos);
}

TEST(ConnectedComponents, AreNumberedByFirstVertexAndIgnoreRejectedEdges) {
  PoseGraph graph;
  for (int i = 0; i < 5; ++i) graph.vertices.push_back({i, Pose(), false});
  for (const auto& [a, b] : {std::pair(3, 1), std::pair(0, 4), std::pair(1, 0)}) {
    GraphEdge edge;
    edge.from = a;
    edge.to = b;
    graph.edges.push_back(edge);
  }
  EXPECT_EQ(connected_components(graph, resolve_edges(graph)), (std::vector<int>{0, 0, 1, 0, 0}));
  graph.edges[2].rejected = true;
  EXPECT_EQ(connected_components(graph, resolve_edges(graph)), (std::vector<int>{0, 1, 2, 1, 0}));
}

}  // namespace
}  // namespace groundloop
