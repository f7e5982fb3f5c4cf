// Rigid transforms in three dimensions, their exponential and logarithm.
//
// A pose `T_a_b` maps coordinates of frame b to frame a: p_a = T_a_b * p_b. Tangent vectors are
// ordered (translation, rotation), in metres and radians, and perturb on the right: T *
// exp_se3(delta).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace groundloop {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Pose() = default;
  Pose(const Eigen::Quaterniond& q, const Eigen::Vector3d& t)
      : rotation(q.normalized()), translation(t) {}
  /// From a 3x3 rotation, which must be orthonormal with determinant 1.
  Pose(const Eigen::Matrix3d& r, const Eigen::Vector3d& t) : rotation(r), translation(t) {
    rotation.normalize();
  }

  [[nodiscard]] Pose inverse() const {
    const Eigen::Quaterniond q = rotation.conjugate();
    Pose result;
    result.rotation = q;
    result.translation = -(q * translation);
    return result;
  }
  [[nodiscard]] Eigen::Matrix3d rotation_matrix() const { return rotation.toRotationMatrix(); }
  [[nodiscard]] Eigen::Matrix4d matrix() const {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = rotation_matrix();
    m.topRightCorner<3, 1>() = translation;
    return m;
  }
};

inline Pose operator*(const Pose& a, const Pose& b) {
  return Pose(a.rotation * b.rotation, a.rotation * b.translation + a.translation);
}
inline Eigen::Vector3d operator*(const Pose& a, const Eigen::Vector3d& p) {
  return a.rotation * p + a.translation;
}

/// A pose in single precision for the hot loops over points.
struct PoseF {
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;
  explicit PoseF(const Pose& pose)
      : rotation(pose.rotation_matrix().cast<float>()),
        translation(pose.translation.cast<float>()) {}
  Eigen::Vector3f operator*(const Eigen::Vector3f& p) const { return rotation * p + translation; }
};

[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Rotation of the rotation vector `w` (rad), exact near zero.
[[nodiscard]] Eigen::Quaterniond exp_so3(const Eigen::Vector3d& w);
/// Rotation vector (rad) of norm at most pi.
[[nodiscard]] Eigen::Vector3d log_so3(const Eigen::Quaterniond& q);
/// Inverse of the right Jacobian of SO(3): log(exp(w) exp(d)) ~ w + right_jacobian_inverse_so3(w)
/// d.
[[nodiscard]] Eigen::Matrix3d right_jacobian_inverse_so3(const Eigen::Vector3d& w);

/// Exponential of a twist (translation, rotation).
[[nodiscard]] Pose exp_se3(const Vector6d& xi);
/// Logarithm (translation, rotation): exp_se3(log_se3(T)) = T.
[[nodiscard]] Vector6d log_se3(const Pose& pose);
/// Adjoint for (translation, rotation): T exp(xi) T^-1 = exp(adjoint(T) xi).
[[nodiscard]] Matrix6d adjoint(const Pose& pose);
/// Inverse of the right Jacobian of SE(3): log(exp(xi) exp(d)) ~ xi +
/// right_jacobian_inverse_se3(xi) d.
[[nodiscard]] Matrix6d right_jacobian_inverse_se3(const Vector6d& xi);

/// Angle of a rotation in radians, in [0, pi].
[[nodiscard]] double rotation_angle(const Eigen::Quaterniond& q);
/// Constant-velocity interpolation on SE(3) from a (s = 0) to b (s = 1); s outside [0, 1]
/// extrapolates.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double s);

}  // namespace groundloop
