// The residual of a measured relative pose, of odometry and of closures alike.
#pragma once

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// log_se3(T_from_to^-1 * T_world_from^-1 * T_world_to): metres and radians, zero where the
/// measurement holds.
[[nodiscard]] Vector6d between_residual(const Pose& T_world_from, const Pose& T_world_to,
                                        const Pose& T_from_to);
/// The same with its derivatives by perturbations on the right of both poses.
Vector6d between_residual(const Pose& T_world_from, const Pose& T_world_to, const Pose& T_from_to,
                          Matrix6d& J_from, Matrix6d& J_to);

/// g2o's own chi-square over the edges that count: sum e' information e with e the translation and
/// the quaternion's vector part (w >= 0) of the residual pose.
[[nodiscard]] double chi2_g2o(const PoseGraph& graph);

}  // namespace groundloop
