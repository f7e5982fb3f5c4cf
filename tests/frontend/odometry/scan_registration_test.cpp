#include "frontend/odometry/scan_registration.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

// The floor and three walls of a room, on a grid with a shift that keeps two samplings apart.
Points room(double spacing, double shift) {
  Points points;
  for (double u = -10.0 + shift; u < 10.0; u += spacing) {
    for (double v = -10.0 + shift; v < 10.0; v += spacing) {
      points.emplace_back(u, v, -2.0);
      if (std::abs(v) > 5.0) continue;
      points.emplace_back(10.0, u, v);
      points.emplace_back(u, -10.0, v);
      points.emplace_back(u, 10.0, v);
    }
  }
  return points;
}

VoxelMap room_map() {
  VoxelMap map(1.0F);
  map.insert(room(0.15, 0.0), Pose());
  return map;
}

RegistrationKernel planes() {
  RegistrationKernel kernel;
  kernel.sigma = 0.3;
  kernel.along_plane = 0.01;
  kernel.scatter_weight = 0.1;
  kernel.stop_translation = 1e-6;
  kernel.stop_rotation = 1e-7;
  return kernel;
}

const Pose kMoved(exp_so3({0.01, -0.02, 0.015}), Eigen::Vector3d(0.1, -0.05, 0.08));

TEST(ScanRegistration, FindsThePoseOfARigidScan) {
  SweepPoints source{room(0.4, 0.07), {}};
  const PoseF back(kMoved.inverse());
  for (Eigen::Vector3f& p : source.points) p = back * p;
  const ScanRegistration found = register_scan(room_map(), source, Pose(), planes());
  const Pose error = kMoved.inverse() * found.pose;
  EXPECT_LT(error.translation.norm(), 5e-3);
  EXPECT_LT(rotation_angle(error.rotation), 5e-4);
}

TEST(ScanRegistration, FindsTheTurnOverASweepWithThePose) {
  // Measured around the clock, so that each time sees one direction, as a spinning sensor does.
  const Eigen::Vector3d turn(0.02, -0.03, 0.025);
  SweepPoints source;
  for (const Eigen::Vector3f& p : room(0.4, 0.07)) {
    const double s = std::atan2(p.y(), p.x()) / M_PI;
    const Pose T = kMoved * Pose(exp_so3(s * turn), Eigen::Vector3d::Zero());
    source.points.push_back((T.inverse() * Eigen::Vector3d(p.cast<double>())).cast<float>());
    source.times.push_back(static_cast<float>(s));
  }
  const ScanRegistration found = register_scan(room_map(), source, Pose(), planes());
  const Pose error = kMoved.inverse() * found.pose;
  EXPECT_LT(error.translation.norm(), 0.01);
  EXPECT_LT(rotation_angle(error.rotation), 1e-3);
  EXPECT_LT((found.turn - turn).norm(), 2e-3);
}

// A hundred kilometres from the start a registration finds the same, in as many iterations.
TEST(ScanRegistration, IsAsFastAndExactFarFromTheStart) {
  const Pose far(exp_so3({0.3, -0.2, 2.0}), Eigen::Vector3d(80'000.0, -60'000.0, 300.0));
  VoxelMap near_map(1.0F), far_map(1.0F);
  // Turned alike, so that the two maps hold the same voxels but for where they lie.
  const Pose turned(far.rotation, Eigen::Vector3d::Zero());
  near_map.insert(room(0.15, 0.0), turned);
  far_map.insert(room(0.15, 0.0), far);
  SweepPoints source{room(0.4, 0.07), {}};
  const PoseF back(kMoved.inverse());
  for (Eigen::Vector3f& p : source.points) p = back * p;
  const ScanRegistration here = register_scan(near_map, source, turned, planes());
  const ScanRegistration there = register_scan(far_map, source, far, planes());
  EXPECT_TRUE(there.converged);
  EXPECT_NEAR(there.iterations, here.iterations, 3);
  const Pose error = (far * kMoved).inverse() * there.pose;
  EXPECT_LT(error.translation.norm(), 5e-3);
  EXPECT_LT(rotation_angle(error.rotation), 5e-4);
}

// A floor alone says nothing of a shift along it or a turn about its normal, and its information
// is that of points with n = z: sum of w [n; p x n] [n; p x n]'.
TEST(ScanRegistration, InformationNamesWhatAFloorCannotTell) {
  VoxelMap map(1.0F);
  Points floor;
  for (double x = -9.95; x < 10.0; x += 0.15) {
    for (double y = -9.95; y < 10.0; y += 0.15) floor.emplace_back(x, y, -2.0);
  }
  map.insert(floor, Pose());
  RegistrationKernel kernel = planes();
  kernel.along_plane = 0.0;
  SweepPoints source;
  for (double x = -8.02; x < 8.0; x += 0.5) {
    for (double y = -8.02; y < 8.0; y += 0.5) source.points.emplace_back(x, y, -2.0);
  }
  Matrix6d expected = Matrix6d::Zero();
  for (const Eigen::Vector3f& p : source.points) {
    Vector6d j;
    j << 0.0, 0.0, 1.0, static_cast<double>(p.y()), -static_cast<double>(p.x()), 0.0;
    expected += j * j.transpose();
  }
  kernel.max_iterations = 1;
  const ScanRegistration found = register_scan(map, source, Pose(), kernel);
  EXPECT_LT((found.information - expected).norm(), 1e-3 * expected.norm());
  EXPECT_NEAR(found.inlier_share, 1.0, 1e-6);
  EXPECT_EQ(found.correspondences, source.points.size());
  EXPECT_LT(found.residual, 1e-4);
}

TEST(ScanRegistration, KeepsTheGuessWhereThereIsNoMap) {
  const VoxelMap empty(1.0F);
  const SweepPoints source{room(0.5, 0.0), std::vector<float>(room(0.5, 0.0).size(), 0.0F)};
  EXPECT_EQ(register_scan(empty, {source.points, {}}, kMoved, planes()).pose.matrix(),
            kMoved.matrix());
  const ScanRegistration turning = register_scan(empty, source, kMoved, planes());
  EXPECT_EQ(turning.pose.matrix(), kMoved.matrix());
  EXPECT_EQ(turning.turn, Eigen::Vector3d(Eigen::Vector3d::Zero()));
}

}  // namespace
}  // namespace groundloop
