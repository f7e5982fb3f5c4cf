// Pose graphs of a known truth for tests and benchmarks: a drive of many laps around a winding
// circuit whose odometry errs as its information says, with closures between laps.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Cholesky>

#include "backend/graph/odometry_information.hpp"
#include "backend/graph/pose_graph.hpp"

namespace groundloop::testing {

struct SimulatedGraph {
  PoseGraph graph;  ///< ids from 0; the guess is the odometry, the first pose is the truth's
  std::vector<Pose> truth;
};

inline Vector6d gaussian(std::mt19937_64& generator, const Matrix6d& covariance) {
  std::normal_distribution<double> normal;
  Vector6d z;
  for (int i = 0; i < 6; ++i) z[i] = normal(generator);
  return covariance.llt().matrixL() * z;
}

/// How the simulated odometry errs; stated here, so that tests do not move with the defaults.
inline OdometryInformationOptions simulated_drift() {
  OdometryInformationOptions options;
  options.translation = 0.02;
  options.rotation = 3e-4;
  options.rotation_per_turn = 2e-3;
  options.translation_floor = 1e-3;
  options.rotation_floor = 2e-5;
  return options;
}

/// Pose at arc position s (m) of a winding circuit about `length` metres around.
inline Pose circuit_pose(double s, double length) {
  const double u = 2.0 * M_PI * s / length;
  const double scale = length / 9.5;
  const Eigen::Vector3d position(scale * std::cos(u) + 0.2 * scale * std::cos(3 * u),
                                 scale * std::sin(u) - 0.2 * scale * std::sin(3 * u),
                                 5.0 * std::sin(2 * u));
  const Eigen::Vector3d forward =
      Eigen::Vector3d(-std::sin(u) - 0.6 * std::sin(3 * u), std::cos(u) - 0.6 * std::cos(3 * u), 0)
          .normalized();
  Eigen::Matrix3d R;
  R << forward, Eigen::Vector3d::UnitZ().cross(forward), Eigen::Vector3d::UnitZ();
  return {R, position};
}

inline Matrix6d closure_covariance() {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 0.0025, 0.0025, 0.0025, 1e-5, 1e-5, 1e-5;
  return covariance;
}

/// `poses` steps of about a metre, a lap each `lap` poses, and `closures` at random between a lap
/// and the one before. Odometry errs `drift` times as much as its information says.
inline SimulatedGraph simulate_graph(int poses, int closures, int lap, std::uint64_t seed,
                                     double drift = 1.0) {
  std::mt19937_64 generator(seed);
  SimulatedGraph result;
  const OdometryInformationOptions options = simulated_drift();
  for (int i = 0; i < poses; ++i) {
    result.truth.push_back(circuit_pose(i, lap));
    if (i == 0) {
      result.graph.vertices.push_back({0, result.truth[0], false});
      continue;
    }
    const Pose step = result.truth[i - 1].inverse() * result.truth[i];
    GraphEdge edge;
    edge.from = i - 1;
    edge.to = i;
    edge.T_from_to =
        step * exp_se3(drift * gaussian(generator, odometry_covariance(step, options)));
    edge.information = odometry_information(step, options);
    result.graph.vertices.push_back({i, result.graph.vertices.back().pose * edge.T_from_to, false});
    result.graph.edges.push_back(edge);
  }
  for (int k = 0; k < closures; ++k) {
    GraphEdge edge;
    edge.kind = EdgeKind::closure;
    edge.from = lap + static_cast<int>(generator() % static_cast<std::uint64_t>(poses - lap));
    edge.to = std::max(0, edge.from - lap + static_cast<int>(generator() % 11) - 5);
    edge.T_from_to = result.truth[edge.from].inverse() * result.truth[edge.to] *
                     exp_se3(gaussian(generator, closure_covariance()));
    edge.information = closure_covariance().inverse();
    result.graph.edges.push_back(edge);
  }
  return result;
}

/// Root mean square distance of the positions, both in the frame they stand in.
inline double position_rmse(const PoseGraph& graph, const std::vector<Pose>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (graph.vertices[i].pose.translation - truth[i].translation).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

}  // namespace groundloop::testing
