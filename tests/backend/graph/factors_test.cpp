// Every kind of factor: what its residual is, and that its derivatives are those of finite
// differences.
#include "backend/graph/factors.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "backend/graph/between_factor.hpp"
#include "backend/graph/vertical_factor.hpp"

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
  edge.from = 0;
  edge.to = 1;
  graph.edges = {edge};
  return graph;
}

// Derivatives of the residual by each variable, and that cost() and linearise() agree.
template <typename Factor>
void expect_derivatives(const PoseGraph& graph, const Factor& factor) {
  const double h = 1e-6;
  const Linearised l = linearise(graph, factor);
  EXPECT_NEAR(cost(graph, factor), 0.5 * l.residual.dot(l.information * l.residual),
              1e-12 * (1.0 + cost(graph, factor)));
  for (int b = 0; b < l.blocks; ++b) {
    const int variable = l.block[b].variable;
    for (int i = 0; i < size_of_variable(graph, variable); ++i) {
      PoseGraph plus = graph, minus = graph;
      perturb(plus, variable, h * Vector6d::Unit(i));
      perturb(minus, variable, -h * Vector6d::Unit(i));
      const Vector6d numeric =
          (linearise(plus, factor).residual - linearise(minus, factor).residual) / (2 * h);
      EXPECT_LT((l.block[b].J.col(i) - numeric).norm(), 1e-6 * (1.0 + numeric.norm()))
          << "variable " << variable << ", direction " << i;
    }
  }
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

TEST(EdgeFactor, DerivativesAgreeWithFiniteDifferences) {
  std::mt19937 generator(6);
  for (int trial = 0; trial < 20; ++trial) {
    PoseGraph graph = two_poses();
    GraphEdge& edge = graph.edges[0];
    edge.T_from_to = exp_se3(random_twist(generator, 3.0, 1.0));
    edge.information = random_information(generator);
    edge.weight = 0.3;
    graph.vertices[0].pose = exp_se3(random_twist(generator, 10.0, 1.5));
    graph.vertices[1].pose =
        graph.vertices[0].pose * edge.T_from_to * exp_se3(random_twist(generator, 1.0, 0.3));
    expect_derivatives(graph, edge);
    edge.bend = 0;
    graph.bends = {Bend(0.02, -0.01)};
    edge.error_by_bend << Eigen::Matrix<double, 6, 2>::Random();
    expect_derivatives(graph, edge);
  }
}

TEST(EdgeFactor, TakesOffWhatTheBendAdds) {
  // Measured too much by the error that a bend of 2 and -1 units makes.
  PoseGraph graph = two_poses();
  GraphEdge& edge = graph.edges[0];
  const Pose truth(exp_so3({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0});
  graph.vertices[1].pose = truth;
  edge.bend = 0;
  edge.error_by_bend.col(0) << 0, 0, 0, 1e-3, 0, 0;
  edge.error_by_bend.col(1) << 0, 0, 0, 0, 0, 2e-3;
  graph.bends = {Bend(2.0, -1.0)};
  edge.T_from_to = truth * exp_se3(edge.error_by_bend * graph.bends[0]);
  EXPECT_LT(cost(graph), 1e-9);
  graph.bends[0].setZero();
  EXPECT_GT(cost(graph), 1e-6);
}

TEST(VerticalFactor, DerivativesAgreeWithFiniteDifferences) {
  std::mt19937 generator(7);
  for (int trial = 0; trial < 20; ++trial) {
    PoseGraph graph;
    graph.vertices = {{0, exp_se3(random_twist(generator, 10.0, 1.0)), false}};
    graph.ups = {random_twist(generator, 1.0, 1.0).head<3>().normalized()};
    const Eigen::Vector3d seen = random_twist(generator, 1.0, 1.0).head<3>().normalized();
    Eigen::Matrix2d covariance;
    covariance << 0.04, 0.01, 0.01, 0.09;
    VerticalFactor vertical = vertical_factor(0, 0, seen, covariance);
    vertical.weight = 0.6;
    expect_derivatives(graph, vertical);
  }
}

TEST(VerticalFactor, CostsTheSquaredAngleOverTheVariance) {
  // The pose leans by 0.01 rad about x, where the vertical is known to 0.02 rad, and is known to
  // 0.005 rad about y: the true vertical is seen leaning along y.
  PoseGraph graph;
  graph.vertices = {{0, Pose(exp_so3({0.01, 0.0, 0.0}), {5.0, 0.0, 0.0}), false}};
  graph.ups = {Eigen::Vector3d::UnitZ()};
  const Eigen::Matrix2d covariance = Eigen::Vector2d(0.005 * 0.005, 0.02 * 0.02).asDiagonal();
  const VerticalFactor vertical = vertical_factor(0, 0, Eigen::Vector3d::UnitZ(), covariance);
  EXPECT_NEAR(cost(graph, vertical), 0.5 * 0.25, 1e-4);
  // However it is turned about the vertical, a pose that sees the vertical upright costs nothing.
  graph.vertices[0].pose = Pose(exp_so3({0.0, 0.0, 1.2}), {5.0, 0.0, 0.0});
  EXPECT_NEAR(cost(graph, vertical), 0.0, 1e-12);
}

TEST(PosePrior, DerivativesAgreeWithFiniteDifferences) {
  std::mt19937 generator(8);
  for (int trial = 0; trial < 20; ++trial) {
    PoseGraph graph;
    PosePrior prior;
    prior.T_world_vertex = exp_se3(random_twist(generator, 10.0, 1.0));
    prior.information = random_information(generator);
    graph.vertices = {
        {0, prior.T_world_vertex * exp_se3(random_twist(generator, 2.0, 0.7)), false}};
    expect_derivatives(graph, prior);
  }
}

TEST(BendPrior, DerivativesAgreeWithFiniteDifferences) {
  PoseGraph graph;
  graph.bends = {Bend(3e-5, 1e-4)};
  BendPrior prior;
  prior.deviation = Bend(1e-4, 2e-4);
  // In units of the deviations: residuals of 0.3 and 0.5.
  EXPECT_NEAR(cost(graph, prior), 0.5 * (0.09 + 0.25), 1e-12);
  const Linearised l = linearise(graph, prior);
  EXPECT_EQ(l.block[0].variable, bend_variable(graph, 0));
  EXPECT_EQ(l.block[0].J(0, 0), 1.0);
  EXPECT_NEAR(l.information(1, 1), 1.0 / (2e-4 * 2e-4), 1.0);
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

}  // namespace
}  // namespace groundloop
