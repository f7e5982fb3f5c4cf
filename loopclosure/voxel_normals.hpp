// Voxels of a local map with the mean of their points and, on demand, the normal of the plane
// through them: what ground alignment samples from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/scan.hpp"

namespace groundloop {

class VoxelNormals {
 public:
  /// Voxels of edge `size` (m) from `max_points` points or up to twice as many, one of each group
  /// of successive points. Points that are not finite or beyond 10 km are left out.
  VoxelNormals(const Points& points, double size, std::size_t max_points);

  [[nodiscard]] std::size_t size() const { return means_.size(); }
  /// Means of the voxels' points, in the order their first points came.
  [[nodiscard]] const std::vector<Eigen::Vector3f>& means() const { return means_; }
  /// Unit normal of the points of voxel i, of either sign; zero where they are fewer than five or
  /// lie on no plane. Computed at the first call.
  [[nodiscard]] const Eigen::Vector3f& normal(std::size_t i) const;

 private:
  /// Sums over points: x, y, z and their number; xx, yy, zz; xy, xz, yz. Four to a register.
  struct Moments {
    Eigen::Array4f first = Eigen::Array4f::Zero(), square = first, mixed = first;
  };
  std::vector<Eigen::Vector3f> means_;
  std::vector<Moments> moments_;  ///< about the voxel's corner
  mutable std::vector<Eigen::Vector3f> normals_;
  mutable std::vector<std::uint8_t> known_;
};

}  // namespace groundloop
