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
  kernel.convergence = 1e-6;
  return kernel;
}

const Pose kMoved(exp_so3({0.01, -0.02, 0.015}), Eigen::Vector3d(0.1, -0.05, 0.08));

TEST(ScanRegistration, FindsThePoseOfARigidScan) {
  Points source = room(0.4, 0.07);
  const PoseF back(kMoved.inverse());
  for (Eigen::Vector3f& p : source) p = back * p;
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
  const TurningRegistration found = register_turning_scan(room_map(), source, Pose(), planes());
  const Pose error = kMoved.inverse() * found.pose;
  EXPECT_LT(error.translation.norm(), 0.01);
  EXPECT_LT(rotation_angle(error.rotation), 1e-3);
  EXPECT_LT((found.turn - turn).norm(), 2e-3);
}

TEST(ScanRegistration, KeepsTheGuessWhereThereIsNoMap) {
  const VoxelMap empty(1.0F);
  const SweepPoints source{room(0.5, 0.0), std::vector<float>(room(0.5, 0.0).size(), 0.0F)};
  EXPECT_EQ(register_scan(empty, source.points, kMoved, planes()).pose.matrix(), kMoved.matrix());
  const TurningRegistration turning = register_turning_scan(empty, source, kMoved, planes());
  EXPECT_EQ(turning.pose.matrix(), kMoved.matrix());
  EXPECT_EQ(turning.turn, Eigen::Vector3d(Eigen::Vector3d::Zero()));
}

}  // namespace
}  // namespace groundloop
