// Constants that datasets publish beside their files, used by readers and by the writers of their
// layouts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "frontend/core/pose.hpp"

namespace groundloop::recordings {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// Rotation of roll, pitch, yaw (rad): first roll about x, then pitch about y, then yaw about z.
[[nodiscard]] inline Eigen::Quaterniond from_roll_pitch_yaw(double roll, double pitch, double yaw) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

/// The record of KITTI and of the many datasets that follow it, all float32.
inline constexpr std::array kKittiFields = {"x", "y", "z", "intensity"};

inline constexpr std::size_t kMulranRows = 64, kMulranColumns = 1024;
inline constexpr double kMulranTurn = 0.1;  // s

/// T_base_lidar of MulRan's calib_base2ouster.txt.
[[nodiscard]] inline Pose mulran_base_from_lidar() {
  return {from_roll_pitch_yaw(0.0001 * kRadiansPerDegree, 0.0003 * kRadiansPerDegree,
                              179.6654 * kRadiansPerDegree),
          Eigen::Vector3d(1.7042, -0.021, 1.8047)};
}

inline constexpr double kNcltScale = 0.005;    // m a unit
inline constexpr double kNcltOffset = -100.0;  // m at unit 0
inline constexpr std::uint16_t kNcltMagic = 44444;

/// Half a turn about x: from NCLT's frames (x forward, y right, z down) to ours, and back.
[[nodiscard]] inline Pose nclt_flip() {
  return {Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), Eigen::Vector3d::Zero()};
}
/// T_body_velodyne of NCLT (Carlevaris-Bianco et al., IJRR 2016), for velodyne_hits.bin; scans of
/// velodyne_sync are in the body's frame.
[[nodiscard]] inline Pose nclt_body_from_velodyne() {
  return {from_roll_pitch_yaw(0.807 * kRadiansPerDegree, 0.166 * kRadiansPerDegree,
                              -90.703 * kRadiansPerDegree),
          Eigen::Vector3d(0.002, -0.004, -0.957)};
}

/// File names up to this stamp hold Aeva records of HeLiPR without the trailing intensity.
inline constexpr std::int64_t kHeliprAevaWithoutIntensity = 1'691'936'557'946'849'179;

}  // namespace groundloop::recordings
