// Which way is up, seen from a pose: what stands upright in a local map says it to a fraction of a
// degree, whatever odometry did on the way there. The frame's own vertical is a variable of two
// unknowns, so that the first pose need not stand level.
#pragma once

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// Two unit vectors across `up`, as columns, that turn with it; `up` has length 1.
[[nodiscard]] Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& up);

/// The factor of a vertical seen: `up` in the vertex's frame, of length 1, and the covariance of
/// its components along across(up), rad^2.
[[nodiscard]] VerticalFactor vertical_factor(int vertex, int frame, const Eigen::Vector3d& up,
                                             const Eigen::Matrix2d& covariance);

/// Residual over its standard deviations.
[[nodiscard]] Eigen::Vector2d residual_of(const PoseGraph& graph, const VerticalFactor& vertical);

}  // namespace groundloop
