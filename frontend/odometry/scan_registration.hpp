// Registration of a scan to the voxel map of odometry (KISS-ICP, Vizzo et al., RA-L 2023, Sec.
// III-D), points to planes where the map has them. A scan is rigid, or turns within its sweep at a
// rate that is found with its pose, as in continuous-time registration (CT-ICP, Dellenbach et al.,
// ICRA 2022).
#pragma once

#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/odometry/voxel_map.hpp"

namespace groundloop {

/// How far correspondences reach, what they weigh, and when to stop.
struct RegistrationKernel {
  double sigma = 1.0;           ///< scale of the robust kernel, m; neighbours within 3 sigma count
  double along_plane = 1.0;     ///< weight along a plane against 1 across it; 1: points to points
  double scatter_weight = 1.0;  ///< of points without a plane
  double convergence = 5e-4;    ///< norm of the update (m, rad) that ends the registration
  int max_iterations = 500;
};

struct ScanRegistration {
  Pose pose;  ///< T_world_scan
  int iterations = 0;
};

/// Moves `source` (scan frame) onto the map, from `guess` on. Where there is nothing to register
/// to, or the system has no solution, the pose is the guess.
[[nodiscard]] ScanRegistration register_scan(const VoxelMap& map, const Points& source,
                                             const Pose& guess, const RegistrationKernel& kernel);

/// Points that were deskewed to the middle of a sweep, and when each was measured.
struct SweepPoints {
  Points points;             ///< m, in the frame of the middle of the sweep
  std::vector<float> times;  ///< one a point: -1 and 1 are the ends of the sweep, 0 its middle
};

struct TurningRegistration {
  Pose pose;             ///< T_world_scan at the middle of the sweep
  Eigen::Vector3d turn;  ///< rad, from the middle to an end: how much farther the sensor turned
                         ///< than the points were deskewed by
  int iterations = 0;
};

/// As register_scan, with the turn over the sweep as three more unknowns.
[[nodiscard]] TurningRegistration register_turning_scan(const VoxelMap& map,
                                                        const SweepPoints& source,
                                                        const Pose& guess,
                                                        const RegistrationKernel& kernel);

}  // namespace groundloop
