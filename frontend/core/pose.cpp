#include "frontend/core/pose.hpp"

#include <cmath>

namespace groundloop {
namespace {

constexpr double kSmallAngle = 1e-5;

// Left Jacobian of SO(3), which is V in exp_se3.
Eigen::Matrix3d left_jacobian_so3(const Eigen::Vector3d& w) {
  const double theta = w.norm();
  const Eigen::Matrix3d W = skew(w);
  if (theta < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * W + (1.0 / 6.0) * W * W;
  const double theta2 = theta * theta;
  const double half_sine = std::sin(0.5 * theta);
  return Eigen::Matrix3d::Identity() + (2.0 * half_sine * half_sine / theta2) * W +
         ((theta - std::sin(theta)) / (theta2 * theta)) * W * W;
}

// (1 - theta/2 cot(theta/2)) / theta^2, by series where the closed form cancels.
double inverse_jacobian_coefficient(double theta) {
  if (theta < 1e-3) return 1.0 / 12.0 + theta * theta / 720.0;
  const double half = 0.5 * theta;
  return (1.0 - half * std::cos(half) / std::sin(half)) / (theta * theta);
}

Eigen::Matrix3d left_jacobian_inverse_so3(const Eigen::Vector3d& w) {
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() - 0.5 * W + inverse_jacobian_coefficient(w.norm()) * W * W;
}

// The block Q of the left Jacobian of SE(3) (Barfoot, State Estimation for Robotics, eq. 7.86b),
// for (rho, phi).
Eigen::Matrix3d left_jacobian_q(const Eigen::Vector3d& rho, const Eigen::Vector3d& phi) {
  const Eigen::Matrix3d R = skew(rho);
  const Eigen::Matrix3d P = skew(phi);
  const double t = phi.norm();
  double a = 0, b = 0, c = 0;
  if (t < 1e-2) {
    const double t2 = t * t;
    a = 1.0 / 6.0 - t2 / 120.0;
    b = 1.0 / 24.0 - t2 / 720.0;
    c = 1.0 / 120.0 - t2 / 2520.0;
  } else {
    const double t2 = t * t, t3 = t2 * t, t4 = t2 * t2, t5 = t4 * t;
    a = (t - std::sin(t)) / t3;
    b = (0.5 * t2 + std::cos(t) - 1.0) / t4;
    c = (t - 1.5 * std::sin(t) + 0.5 * t * std::cos(t)) / t5;
  }
  return 0.5 * R + a * (P * R + R * P + P * R * P) + b * (P * P * R + R * P * P - 3.0 * P * R * P) +
         c * (P * R * P * P + P * P * R * P);
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& w) {
  const double theta = w.norm();
  const double half = 0.5 * theta;
  const double k = theta < kSmallAngle ? 0.5 - theta * theta / 48.0 : std::sin(half) / theta;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = k * w;
  q.normalize();
  return q;
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double w = sign * q.w();
  const double s = v.norm();
  if (s < kSmallAngle) return (2.0 / w) * (1.0 - s * s / (3.0 * w * w)) * v;
  return (2.0 * std::atan2(s, w) / s) * v;
}

Eigen::Matrix3d right_jacobian_inverse_so3(const Eigen::Vector3d& w) {
  return left_jacobian_inverse_so3(-w);
}

Pose exp_se3(const Vector6d& xi) {
  const Eigen::Vector3d w = xi.tail<3>();
  return Pose(exp_so3(w), left_jacobian_so3(w) * xi.head<3>());
}

Vector6d log_se3(const Pose& pose) {
  Vector6d xi;
  const Eigen::Vector3d w = log_so3(pose.rotation);
  xi.head<3>() = left_jacobian_inverse_so3(w) * pose.translation;
  xi.tail<3>() = w;
  return xi;
}

Matrix6d adjoint(const Pose& pose) {
  const Eigen::Matrix3d R = pose.rotation_matrix();
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = R;
  m.bottomRightCorner<3, 3>() = R;
  m.topRightCorner<3, 3>() = skew(pose.translation) * R;
  return m;
}

Matrix6d right_jacobian_inverse_se3(const Vector6d& xi) {
  const Eigen::Vector3d rho = -xi.head<3>();
  const Eigen::Vector3d phi = -xi.tail<3>();
  const Eigen::Matrix3d J = left_jacobian_inverse_so3(phi);
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = J;
  m.bottomRightCorner<3, 3>() = J;
  m.topRightCorner<3, 3>() = -J * left_jacobian_q(rho, phi) * J;
  return m;
}

double rotation_angle(const Eigen::Quaterniond& q) {
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

Pose interpolate(const Pose& a, const Pose& b, double s) {
  return a * exp_se3(s * log_se3(a.inverse() * b));
}

}  // namespace groundloop
