// A point cloud as cells of 0.5, 1, 2, 4 ... m with their means and, where wanted, their planes:
// what closures are refined on. Cells keep the order in which their first points come, so that
// everything summed over them is the same from run to run.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/scan.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {

/// Points further out than this (m) are no part of a map: they are left out, never cast to a cell.
constexpr float kFurthestPoint = 1e5F;

/// False for points that are not finite, too.
[[nodiscard]] inline bool has_voxel(const Eigen::Vector3f& point) {
  return point.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < kFurthestPoint;
}

struct VoxelLevel {
  float voxel_size = 0.0F;
  VoxelTable index;
  std::vector<Eigen::Vector3f> means;  ///< of the points of a cell
  /// Unit normals of the cells' surfaces; zero where the points form none. Empty without planes.
  std::vector<Eigen::Vector3f> normals;
  /// Variance of the points across the surface, m^2.
  std::vector<float> variances;
  /// Variance of the normal's tilt towards any direction in the surface, rad^2.
  std::vector<float> normal_variances;
};

class VoxelPyramid {
 public:
  /// Cells of `voxel_size`, then twice that, `levels` times; `planes` adds normals. Points without
  /// a voxel (has_voxel) are left out.
  VoxelPyramid(const Points& points, double voxel_size, int levels, bool planes);

  /// Finest first.
  [[nodiscard]] const std::vector<VoxelLevel>& levels() const { return levels_; }
  [[nodiscard]] const VoxelLevel& finest() const { return levels_.front(); }

 private:
  std::vector<VoxelLevel> levels_;
};

}  // namespace groundloop
