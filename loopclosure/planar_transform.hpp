// Rigid motions of the plane: what two density images can differ by. Always a proper rotation,
// never a reflection.
#pragma once

#include <cmath>
#include <span>

#include <Eigen/Core>

#include "frontend/core/pose.hpp"

namespace groundloop {

/// T_a_b: p_a = R(angle) p_b + translation; radians and metres.
struct PlanarTransform {
  double angle = 0.0;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();
};

[[nodiscard]] inline Eigen::Matrix2d rotation_matrix(const PlanarTransform& T) {
  const double c = std::cos(T.angle), s = std::sin(T.angle);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}
inline Eigen::Vector2d operator*(const PlanarTransform& T, const Eigen::Vector2d& p) {
  return rotation_matrix(T) * p + T.translation;
}

/// The same motion in three dimensions: about z, along x and y.
[[nodiscard]] Pose lift(const PlanarTransform& T);

/// The T_a_b that minimises the sum of |a_i - T b_i|^2 (Kabsch and Umeyama with the rotation kept
/// proper: V diag(1, det(V U')) U', which in two dimensions is the angle below; the translation
/// after it). Points without extent leave the rotation at zero. Both spans have the same size; none
/// gives the identity.
[[nodiscard]] PlanarTransform fit_planar_transform(std::span<const Eigen::Vector2d> a,
                                                   std::span<const Eigen::Vector2d> b);

/// An angle brought to (-pi, pi].
[[nodiscard]] double wrap_angle(double angle);

}  // namespace groundloop
