#include "frontend/core/pose.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

namespace groundloop {
namespace {

Vector6d random_twist(std::mt19937& rng, double scale) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi(i) = uniform(rng);
  return xi;
}

Eigen::Matrix4d hat(const Vector6d& xi) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m.topLeftCorner<3, 3>() = skew(xi.tail<3>());
  m.topRightCorner<3, 1>() = xi.head<3>();
  return m;
}

class PoseAtScale : public ::testing::TestWithParam<double> {};

TEST_P(PoseAtScale, ExponentialEqualsTheMatrixExponential) {
  std::mt19937 rng(1);
  for (int i = 0; i < 20; ++i) {
    const Vector6d xi = random_twist(rng, GetParam());
    const Eigen::Matrix4d expected = hat(xi).exp();
    EXPECT_LT((exp_se3(xi).matrix() - expected).norm(), 1e-12);
  }
}

TEST_P(PoseAtScale, LogarithmInvertsTheExponential) {
  std::mt19937 rng(2);
  for (int i = 0; i < 20; ++i) {
    const Vector6d xi = random_twist(rng, GetParam());
    EXPECT_LT((log_se3(exp_se3(xi)) - xi).norm(), 1e-9);
  }
}

TEST_P(PoseAtScale, InverseRightJacobianAgreesWithFiniteDifferences) {
  std::mt19937 rng(3);
  const double h = 1e-6;
  for (int i = 0; i < 20; ++i) {
    const Vector6d xi = random_twist(rng, GetParam());
    const Matrix6d J = right_jacobian_inverse_se3(xi);
    for (int k = 0; k < 6; ++k) {
      Vector6d d = Vector6d::Zero();
      d(k) = h;
      const Vector6d column =
          (log_se3(exp_se3(xi) * exp_se3(d)) - log_se3(exp_se3(xi) * exp_se3(-d))) / (2 * h);
      EXPECT_LT((column - J.col(k)).norm(), 1e-7) << "column " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scales, PoseAtScale, ::testing::Values(1e-9, 1e-4, 2e-3, 0.1, 1.5));

TEST(Pose, AdjointMovesATwistThroughAPose) {
  std::mt19937 rng(4);
  const Pose T = exp_se3(random_twist(rng, 1.0));
  const Vector6d xi = random_twist(rng, 0.5);
  const Pose left = T * exp_se3(xi) * T.inverse();
  const Pose right = exp_se3(adjoint(T) * xi);
  EXPECT_LT((left.matrix() - right.matrix()).norm(), 1e-12);
}

TEST(Pose, InterpolationMeetsBothEnds) {
  std::mt19937 rng(5);
  const Pose a = exp_se3(random_twist(rng, 1.0)), b = exp_se3(random_twist(rng, 1.0));
  EXPECT_LT((interpolate(a, b, 0.0).matrix() - a.matrix()).norm(), 1e-12);
  EXPECT_LT((interpolate(a, b, 1.0).matrix() - b.matrix()).norm(), 1e-12);
}

TEST(Pose, RotationAngleOfAHalfTurn) {
  EXPECT_NEAR(rotation_angle(exp_so3({0, 0, M_PI})), M_PI, 1e-12);
  EXPECT_NEAR(rotation_angle(exp_so3({0, -0.25, 0})), 0.25, 1e-12);
}

}  // namespace
}  // namespace groundloop
