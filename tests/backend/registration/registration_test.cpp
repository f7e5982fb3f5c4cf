#include "backend/registration/registration.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "frontend/core/parallel.hpp"
#include "tests/support/registration_pair.hpp"
#include "tests/support/street_scene.hpp"

namespace groundloop {
namespace {

using testing::StreetScene;
using testing::transformed;

constexpr double kDegree = std::numbers::pi / 180.0;

Pose pose_of(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d xi;
  xi << x, y, z, rx * kDegree, ry * kDegree, rz * kDegree;
  return exp_se3(xi);
}

class RegistrationFrom : public ::testing::TestWithParam<Pose> {};

TEST_P(RegistrationFrom, ConvergesFromTwoMetresAndFiveDegrees) {
  const StreetScene scene(1);
  const Points target = scene.sample(40000, 0.02, 11);
  const Pose T_target_source = pose_of(12.0, 0.5, 0.3, 1.0, -0.5, 20.0);
  const Points source = transformed(scene.sample(40000, 0.02, 12), T_target_source.inverse());
  const RegistrationOptions options;
  const RegistrationResult result = register_points(RegistrationTarget(target, options), source,
                                                    T_target_source * GetParam(), options);
  EXPECT_TRUE(result.converged) << result.failure;
  const Vector6d error = log_se3(T_target_source.inverse() * result.T_target_source);
  EXPECT_LT(error.head<3>().norm(), 0.02);
  EXPECT_LT(error.tail<3>().norm(), 0.05 * kDegree);
  EXPECT_LT(result.rmse, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Starts, RegistrationFrom,
                         ::testing::Values(Pose(), pose_of(2, 0, 0, 0, 0, 5),
                                           pose_of(-1.2, 1.2, 1.0, 0, 0, -5),
                                           pose_of(0, -2, 0, 3, 3, 2.6),
                                           pose_of(1.2, 1.2, -1.0, -3, 2, 3.4)));

TEST(Registration, FindsTheKnownPoseOfARealPair) {
  const testing::RegistrationPair pair = testing::registration_pair();
  if (pair.source.empty()) GTEST_SKIP() << "needs " GROUNDLOOP_SHARED_DATA "/registration";
  RegistrationOptions options;
  options.voxel_size = 0.25;  // single scans, not maps
  const RegistrationResult result =
      register_points(RegistrationTarget(pair.target, options), pair.source, Pose(), options);
  EXPECT_TRUE(result.converged) << result.failure;
  const Vector6d error = log_se3(pair.T_target_source.inverse() * result.T_target_source);
  EXPECT_LT(error.head<3>().norm(), 0.03);
  EXPECT_LT(error.tail<3>().norm(), 0.3 * kDegree);
}

TEST(Registration, GivesTheSameBytesWithOneAndTwoThreads) {
  const StreetScene scene(2);
  const Points target = scene.sample(30000, 0.02, 1);
  const Points source = scene.sample(30000, 0.02, 2);
  const RegistrationOptions options;
  RegistrationResult results[2];
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    results[threads - 1] = register_points(RegistrationTarget(target, options), source,
                                           pose_of(1, 0.5, 0, 0, 0, 2), options);
  }
  set_thread_count(0);
  EXPECT_EQ(results[0].T_target_source.matrix(), results[1].T_target_source.matrix());
  EXPECT_EQ(results[0].information, results[1].information);
}

TEST(Registration, ATunnelLeavesItsAxisWeak) {
  // Floor and two walls along x, nothing across.
  std::mt19937 generator(5);
  const auto tunnel = [&] {
    Points points;
    for (int i = 0; i < 30000; ++i) {
      const auto u = static_cast<float>(generator()) / 4294967296.0F;
      const auto v = static_cast<float>(generator()) / 4294967296.0F;
      const float x = 100.0F * u - 50.0F;
      const float side = i % 3 == 0 ? -4.0F : 4.0F;
      points.push_back(i % 3 == 2 ? Eigen::Vector3f(x, 8.0F * v - 4.0F, 0.0F)
                                  : Eigen::Vector3f(x, side, 5.0F * v));
    }
    return points;
  };
  const RegistrationOptions options;
  const Points target = tunnel();
  const RegistrationResult result =
      register_points(RegistrationTarget(target, options), tunnel(), Pose(), options);
  // Across, the position is known to centimetres; along the axis it is not.
  EXPECT_LT(1.0 / std::sqrt(result.information(1, 1)), 0.3);
  EXPECT_LT(1.0 / std::sqrt(result.information(2, 2)), 0.3);
  EXPECT_GT(1.0 / std::sqrt(result.information(0, 0)), 1.0);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(result.information);
  EXPECT_GT(std::abs(solver.eigenvectors()(0, 0)), 0.99);
  EXPECT_GE(solver.eigenvalues()[0], -1e-9);
}

TEST(Registration, InformationDescribesTheErrorAtTheSourceOrigin) {
  // The same pair with the source's frame moved 30 m away: the covariance moves by the adjoint, up
  // to the drift that the longer way to the overlap adds.
  const StreetScene scene(3);
  const Points target = scene.sample(30000, 0.02, 1);
  const Points source = scene.sample(30000, 0.02, 2);
  RegistrationOptions options;
  options.translation_drift = 0.0;
  options.rotation_drift_deg = 0.0;
  const RegistrationTarget prepared(target, options);
  const RegistrationResult near = register_points(prepared, source, Pose(), options);
  const Pose T_source_far = pose_of(30, 0, 0, 0, 0, 0);
  const RegistrationResult far =
      register_points(prepared, transformed(source, T_source_far.inverse()), T_source_far, options);
  const Matrix6d ad = adjoint(T_source_far);
  const Matrix6d expected = ad.transpose() * near.information * ad;
  EXPECT_LT((far.information - expected).norm(), 0.05 * expected.norm());
}

TEST(Registration, NeverClaimsMoreThanTheFloor) {
  const StreetScene scene(3);
  const RegistrationOptions options;
  const RegistrationResult result =
      register_points(RegistrationTarget(scene.sample(60000, 0.01, 1), options),
                      scene.sample(60000, 0.01, 2), Pose(), options);
  const Matrix6d covariance = result.information.inverse();
  const double turn = options.rotation_floor_deg * kDegree;
  for (int k = 0; k < 3; ++k) {
    EXPECT_GE(std::sqrt(covariance(k, k)), 0.999 * options.translation_floor);
    EXPECT_GE(std::sqrt(covariance(3 + k, 3 + k)), 0.999 * turn);
  }
}

TEST(Registration, DoesNotConvergeOnBadGeometry) {
  const StreetScene scene(1);
  const Points target = scene.sample(20000, 0.02, 1);
  const RegistrationOptions options;
  const RegistrationTarget prepared(target, options);
  EXPECT_FALSE(register_points(prepared, {}, Pose(), options).converged);
  EXPECT_FALSE(register_points(prepared, scene.sample(50, 0.02, 2), Pose(), options).converged);
  EXPECT_FALSE(register_points(RegistrationTarget({}, options), target, Pose(), options).converged);
  EXPECT_FALSE(register_points(prepared, target, pose_of(5000, 0, 0, 0, 0, 0), options).converged);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const RegistrationResult result =
      register_points(prepared, Points(1000, Eigen::Vector3f(nan, nan, nan)), Pose(), options);
  EXPECT_FALSE(result.converged);
  EXPECT_FALSE(result.failure.empty());
}

TEST(Registration, SurvivesPointsThatAreNotFiniteOrFarAway) {
  const StreetScene scene(4);
  Points target = scene.sample(30000, 0.02, 1);
  Points source = scene.sample(30000, 0.02, 2);
  const float inf = std::numeric_limits<float>::infinity();
  target.insert(target.begin(), {inf, 0.0F, 1e30F});
  source.insert(source.begin(), {std::numeric_limits<float>::quiet_NaN(), -inf, 3e7F});
  const RegistrationOptions options;
  const RegistrationResult result = register_points(RegistrationTarget(target, options), source,
                                                    pose_of(1, 0, 0, 0, 0, 1), options);
  EXPECT_TRUE(result.converged) << result.failure;
  EXPECT_LT(result.T_target_source.translation.norm(), 0.03);
}

TEST(Registration, FindsUpInATiltedMap) {
  const StreetScene scene(4);
  const Pose tilt = pose_of(0, 0, 0, 20, 10, 0);
  const RegistrationTarget target(transformed(scene.sample(40000, 0.02, 1), tilt), {});
  const Eigen::Vector3d up = tilt.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_GT(up.dot(target.up().cast<double>()), std::cos(3.0 * kDegree));
}

}  // namespace
}  // namespace groundloop
