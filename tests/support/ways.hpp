// A way whose odometry and true poses are known, the truth in a frame of one's choice.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "frontend/core/pose.hpp"

namespace groundloop::testing {

// KITTI's camera in its LiDAR's frame: z forward, x right, y down, and 0.3 m ahead.
inline Pose camera_lidar() {
  Eigen::Matrix3d rotation;
  rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {rotation, Eigen::Vector3d(0.0, -0.08, -0.27)};
}

struct Ways {
  std::vector<Pose> estimate, truth;  // the sensor's with errors, the body's without
};

// A way through a hilly town (planar: a flat one), `drift` of odometry in the estimate.
inline Ways ways(const Pose& T_body_sensor, double drift, bool planar, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Ways result;
  Pose truth;
  Pose estimate(exp_so3({0.1, 0.2, 0.3}), Eigen::Vector3d(5, 6, 7));
  for (int i = 0; i < 1500; ++i) {
    const double s = 0.02 * i;
    Vector6d twist;
    twist << 1.0, 0.0, planar ? 0.0 : 0.02 * std::sin(s), 0.0,
        planar ? 0.0 : 0.01 * std::sin(1.3 * s), 0.06 * std::sin(s) * std::sin(0.17 * s);
    result.estimate.push_back(estimate);
    result.truth.push_back(truth * T_body_sensor.inverse());
    truth = truth * exp_se3(twist);
    Vector6d noise;
    for (int k = 0; k < 6; ++k) noise[k] = drift * (k < 3 ? 0.02 : 0.0008) * normal(generator);
    estimate = estimate * exp_se3(twist + noise);
  }
  return result;
}

}  // namespace groundloop::testing
