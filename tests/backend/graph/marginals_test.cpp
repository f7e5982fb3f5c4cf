// Covariances of a solved graph, against dense algebra and against the errors of many simulated
// drives.
#include "backend/graph/marginals.hpp"

#include <array>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "backend/graph/solver.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

// The inverse of the normal matrix over all poses but the first, which is held.
Eigen::MatrixXd dense_covariance(const PoseGraph& graph) {
  const auto n = static_cast<Eigen::Index>(graph.vertices.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  for (const GraphEdge& edge : graph.edges) {
    const Linearised l = linearise(graph, edge);
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        H.block<6, 6>(6 * l.block[a].variable, 6 * l.block[b].variable) +=
            l.block[a].J.transpose() * l.information * l.block[b].J;
      }
    }
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  covariance.bottomRightCorner(6 * n - 6, 6 * n - 6) =
      H.bottomRightCorner(6 * n - 6, 6 * n - 6).inverse();
  return covariance;
}

PoseGraph solved_drive(int poses, int closures, std::uint32_t seed, std::vector<Pose>* truth) {
  testing::SimulatedGraph simulated = testing::simulate_graph(poses, closures, poses / 2, seed);
  solve(simulated.graph, gauge(simulated.graph), {});
  if (truth != nullptr) *truth = simulated.truth;
  return simulated.graph;
}

TEST(Marginals, AreThoseOfDenseAlgebra) {
  const PoseGraph graph = solved_drive(40, 5, 3, nullptr);
  const Eigen::MatrixXd dense = dense_covariance(graph);
  Marginals marginals(graph, gauge(graph));
  EXPECT_TRUE(marginals.of_pose(0).isZero(0.0));
  const std::array<int, 4> to{0, 7, 20, 39};
  for (const int from : {0, 13}) {
    const std::vector<RelativePose> between = marginals.between(from, to);
    for (std::size_t i = 0; i < to.size(); ++i) {
      const Matrix6d own = dense.block<6, 6>(6 * to[i], 6 * to[i]);
      EXPECT_LT((marginals.of_pose(to[i]) - own).norm(), 1e-6 * own.norm() + 1e-15);
      // T = A^-1 B moves by db - Ad(T^-1) da.
      const Pose T = graph.vertices[from].pose.inverse() * graph.vertices[to[i]].pose;
      Eigen::Matrix<double, 6, 12> J;
      J << -adjoint(T.inverse()), Matrix6d::Identity();
      Eigen::Matrix<double, 12, 12> joint;
      joint << dense.block<6, 6>(6 * from, 6 * from), dense.block<6, 6>(6 * from, 6 * to[i]),
          dense.block<6, 6>(6 * to[i], 6 * from), own;
      const Matrix6d expected = J * joint * J.transpose();
      EXPECT_LT((between[i].covariance - expected).norm(), 1e-6 * expected.norm() + 1e-12);
      EXPECT_LT(log_se3(between[i].T_from_to.inverse() * T).norm(), 1e-12);
    }
  }
}

TEST(Marginals, OfAChainAreThoseOfItsComposition) {
  const PoseGraph graph = solved_drive(60, 0, 4, nullptr);
  RelativePose chain;
  for (int i = 20; i < 50; ++i)
    chain = chain * RelativePose{graph.edges[i].T_from_to, graph.edges[i].information.inverse()};
  const std::array<int, 1> to{50};
  const RelativePose between = Marginals(graph, gauge(graph)).between(20, to).front();
  EXPECT_LT((between.covariance - chain.covariance).norm(), 1e-6 * chain.covariance.norm());
}

TEST(Marginals, SayNothingWhereAPoseIsOpen) {
  PoseGraph graph = solved_drive(20, 0, 5, nullptr);
  graph.edges[10].information.setZero();
  EXPECT_FALSE(pose_covariances(graph).has_value());
}

// Errors of poses, normalised by the covariances, are chi-square of six degrees of freedom: their
// mean over many drives is 6. Poses of one drive err together; 60 drives, a tenth of the mean.
TEST(Marginals, DescribeTheErrorsOfSimulatedDrives) {
  double sum = 0.0;
  int count = 0, inside = 0;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    std::vector<Pose> truth;
    const PoseGraph graph = solved_drive(300, 8, seed, &truth);
    const std::vector<Matrix6d> covariances = pose_covariances(graph).value();
    for (const std::size_t i : {60U, 120U, 180U, 240U, 299U}) {
      const RelativePose error{graph.vertices[i].pose.inverse() * truth[i], covariances[i]};
      const double nees = squared_mahalanobis(error);
      sum += nees;
      inside += nees < 12.592 ? 1 : 0;  // 95 % of chi-square with 6 degrees of freedom
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 6.0, 0.9);
  EXPECT_GT(inside, 0.90 * count);
  EXPECT_LT(inside, 0.99 * count);
}

}  // namespace
}  // namespace groundloop
