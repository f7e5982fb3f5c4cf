// Binary and Triangle Combined descriptors (Yuan et al., T-RO 2024): key points where what stands
// on the largest plane fills many heights, each with the heights that it fills. With its authors'
// settings for outdoors.
#pragma once

#include "tests/benchmarks/baselines/triangles.hpp"

namespace groundloop::baselines {

/// Planes that lie in one another joined, twice over; the one with the most points. Without any:
/// the horizontal plane through `point`.
[[nodiscard]] FlatVoxel largest_plane(const PlaneVoxels& voxels, const Eigen::Vector3d& point);
/// At most five hundred.
[[nodiscard]] std::vector<KeyPoint> height_corners(const std::vector<Eigen::Vector3d>& cloud,
                                                   const FlatVoxel& ground);
/// The mean similarity of the three corners' heights is above 0.7.
[[nodiscard]] bool alike_in_heights(const Triangle& a, const Triangle& b);

[[nodiscard]] MapPairs detect_by_btc(const SessionScans& references, const SessionScans& queries);

}  // namespace groundloop::baselines
