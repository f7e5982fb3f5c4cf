// Stamped poses, and the two text forms they are kept in: TUM (stamp tx ty tz qx qy qz qw) and
// KITTI (3x4 row-major).
#pragma once

#include <filesystem>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

struct StampedPose {
  Nanoseconds stamp = 0;
  Pose pose;
};
using Trajectory = std::vector<StampedPose>;

/// Sum of the distances between successive positions, metres.
[[nodiscard]] double path_length(const Trajectory& trajectory);

/// Reads a TUM file; lines that start with '#' are comments. Throws InputError naming file and
/// line.
[[nodiscard]] Trajectory read_tum(const std::filesystem::path& file);
/// Reads a KITTI file (12 numbers a line); throws InputError where a matrix is no rotation (beyond
/// 1e-3).
[[nodiscard]] std::vector<Pose> read_kitti_poses(const std::filesystem::path& file);

/// Written aside and renamed; stamps with nine decimals, poses with enough digits to be read back
/// the same.
void write_tum(const std::filesystem::path& file, const Trajectory& trajectory);
void write_kitti_poses(const std::filesystem::path& file, const Trajectory& trajectory);

}  // namespace groundloop
