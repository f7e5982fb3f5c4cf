// A map against a true one: how far its points lie from the truth (accuracy), how much of the truth
// it has (completeness), both together (Chamfer distance), and how the points of voxels are spread
// (average Wasserstein distance of Gaussians, as MapEval, Hu et al., RA-L 2025, has it).
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

struct MapComparison {
  double accuracy_m = 0.0;       ///< rms over matched points of the map, to the nearest true point
  double mean_distance_m = 0.0;  ///< the same, mean
  double matched_share = 0.0;    ///< of the map's points, that have a true one within the limit
  double completeness = 0.0;     ///< of the true points, that have one of the map within the limit
  double chamfer_m = 0.0;        ///< mean of both directions' mean distances over matched points
  double wasserstein_m = 0.0;    ///< mean over voxels that both fill
  std::size_t voxels = 0;
  double limit_m = 0.0, voxel_m = 0.0;
};

/// Both maps in one frame. Voxels of `voxel` metres count where each map has 30 points in them.
[[nodiscard]] MapComparison compare_maps(const Points& map, const Points& truth, double limit,
                                         double voxel);

/// Squared 2-Wasserstein distance of two Gaussians, m^2.
[[nodiscard]] double wasserstein_squared(const Eigen::Vector3d& mean_a,
                                         const Eigen::Matrix3d& cov_a,
                                         const Eigen::Vector3d& mean_b,
                                         const Eigen::Matrix3d& cov_b);

/// T_truth_map of least squares by point-to-point ICP from a guess, over points within `limit`.
[[nodiscard]] Pose align_maps(const Points& map, const Points& truth, const Pose& guess,
                              double limit);

}  // namespace groundloop
