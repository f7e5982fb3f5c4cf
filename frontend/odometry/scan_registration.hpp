// Registration of a scan to the voxel map of odometry (KISS-ICP, Vizzo et al., RA-L 2023, Sec.
// III-D), points to planes where the map has them. Perturbations are taken on the right, in the
// scan's own frame, and the map is seen from an anchor nearby, so that neither cost nor precision
// depends on where in the world the scan lies.
//
// A scan is rigid, or turns within its sweep at a rate that is found with its pose, as in
// continuous-time registration (CT-ICP, Dellenbach et al., ICRA 2022).
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/odometry/voxel_map.hpp"

namespace groundloop {

/// Points that were deskewed to the middle of a sweep, and when each was measured.
struct SweepPoints {
  Points points;             ///< m, in the frame of the middle of the sweep
  std::vector<float> times;  ///< one a point: -1 and 1 are the ends of the sweep, 0 its middle;
                             ///< empty where the scan is rigid
};

/// How far correspondences reach, what they weigh, and when to stop.
struct RegistrationKernel {
  double sigma = 1.0;           ///< scale of the robust kernel, m; neighbours within 3 sigma count
  double along_plane = 1.0;     ///< weight along a plane against 1 across it; 1: points to points
  double scatter_weight = 1.0;  ///< of points without a plane
  /// An update that moves the scan's origin by less, m, and turns it by less, rad, is the last.
  double stop_translation = 5e-4;
  double stop_rotation = 1e-4;
  int max_iterations = 500;
};

/// What a registration found, and what it knows of how well.
struct ScanRegistration {
  Pose pose;  ///< T_world_scan, at the middle of the sweep
  /// rad, from the middle of the sweep to an end: how much farther the sensor turned than the
  /// points were deskewed by; zero where the scan is rigid.
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  int iterations = 0;
  bool converged = false;           ///< by the stop, before max_iterations
  std::size_t correspondences = 0;  ///< at the last iteration
  double inlier_share = 0.0;        ///< weight of the correspondences over the number of points
  double residual = 0.0;            ///< weighted rms of the residuals, m
  /// Of the points alone, were each residual 1 m; over residual^2 it is the pose's information.
  /// Perturbation on the right, order tx ty tz rx ry rz.
  Matrix6d information = Matrix6d::Zero();
};

/// Moves `source` onto the map, from `guess` on. Where there is nothing to register to, or the
/// system has no solution, the pose is the guess and `converged` is false.
[[nodiscard]] ScanRegistration register_scan(const VoxelMap& map, const SweepPoints& source,
                                             const Pose& guess, const RegistrationKernel& kernel);

/// Mean distance, m, of the points of a scan at a pose from their neighbours in the map; those
/// without one within `max_distance` count as that far.
[[nodiscard]] double mean_distance(const VoxelMap& map, const Points& points,
                                   const Pose& T_world_scan, double max_distance);

}  // namespace groundloop
