// How well the values of a solved pose graph are known: covariances from the factor of its normal
// equations, about the values it has.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "backend/graph/normal_equations.hpp"
#include "backend/graph/relative_pose.hpp"

namespace groundloop {

class Marginals {
 public:
  /// `held` as for solve(). Throws InputError where the graph leaves a pose open.
  Marginals(const PoseGraph& graph, const std::vector<char>& held);

  /// Covariance of T_world_vertex, perturbed on the right; zero where it is held.
  [[nodiscard]] Matrix6d of_pose(int vertex);
  /// Pose of each of `to` in `from`, with the covariance that the whole graph leaves it; one
  /// solution of six columns.
  [[nodiscard]] std::vector<RelativePose> between(int from, std::span<const int> to);

 private:
  Eigen::MatrixXd inverse_block(int i, int j);

  const PoseGraph& graph_;
  NormalEquations equations_;
  bool inverted_ = false;
};

/// Covariance of every pose against the vertex that its component is held by (gauge()); nothing
/// where the graph leaves a pose open.
[[nodiscard]] std::optional<std::vector<Matrix6d>> pose_covariances(const PoseGraph& graph);

}  // namespace groundloop
