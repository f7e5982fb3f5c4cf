// Ground alignment (Sec. 3.2 of the paper): the transform that lays a local map's ground onto the
// xy-plane, from the lowest voxels of a grid, the principal component of their normals and a
// weighted least-squares fit. Unlike the paper, the lowest voxels are sampled along several
// candidate directions, so that strongly tilted maps align too. Heading and position along the
// ground are left as they are.
#pragma once

#include <cstddef>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

struct GroundAlignment {
  Pose T_ground_map;
  /// Share of the occupied cells whose lowest voxel lies on the plane, in [0, 1]; 0 where there is
  /// no ground.
  double quality = 0.0;
  std::size_t ground_cells = 0;  ///< cells on the plane
  /// False where no plane was found: the rotation is the identity and only the height is shifted,
  /// by the median of the lowest voxels.
  bool found = false;
};

/// Aligns `map_points` (m, in the map frame, whose z axis points upward to within a right angle).
/// Points that are not finite or farther than 10 km from the origin are left out. No points: the
/// identity.
[[nodiscard]] GroundAlignment align_to_ground(const Points& map_points,
                                              const GroundAlignmentOptions& options);

}  // namespace groundloop
