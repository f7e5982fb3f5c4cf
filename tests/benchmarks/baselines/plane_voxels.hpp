// Voxels of 2 m whose points lie on a plane: where STD and BTC begin, and what they verify by.
#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/scan.hpp"
#include "tests/benchmarks/baselines/voxel_means.hpp"

namespace groundloop::baselines {

struct FlatVoxel {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double points = 0;
};

struct PlaneVoxel {
  std::vector<Eigen::Vector3d> points;
  bool is_plane = false;
  FlatVoxel plane;
};
using PlaneVoxels = std::map<VoxelIndex, PlaneVoxel>;

/// A voxel of more than ten points is a plane where they lie within 0.1 m (least eigenvalue of
/// their covariance under 0.01 m^2).
[[nodiscard]] PlaneVoxels plane_voxels(const std::vector<Eigen::Vector3d>& points);
[[nodiscard]] std::vector<FlatVoxel> planes_of(const PlaneVoxels& voxels);

/// Mean, covariance and normal of two sets of points as one.
[[nodiscard]] FlatVoxel joined(const FlatVoxel& a, const FlatVoxel& b);

/// Whether two normals, of either sign, differ by less than `bound`.
[[nodiscard]] bool parallel(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double bound);

/// Share of the planes of `query`, moved by T_reference_query, that one of the three nearest planes
/// of the reference continues: normals within 0.2, 0.5 m apart.
[[nodiscard]] double plane_agreement(const std::vector<FlatVoxel>& query,
                                     const std::vector<FlatVoxel>& reference,
                                     const Eigen::Matrix3d& rotation,
                                     const Eigen::Vector3d& translation);

}  // namespace groundloop::baselines
