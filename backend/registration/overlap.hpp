// How much of two local maps is the same space: the shared occupied voxels over those of the
// smaller map (the overlap of the paper and of closures.csv). Blind to what lies inside a voxel, so
// that it cannot tell one arch of a bridge from the next.
#pragma once

#include "backend/registration/voxel_pyramid.hpp"
#include "frontend/core/pose.hpp"

namespace groundloop {

/// Voxels of `voxel_size` metres in the query map's frame that both maps occupy, over the number of
/// those that the map with fewer occupies; in [0, 1], 0 where a map is empty.
[[nodiscard]] double volumetric_overlap(const Points& reference, const Points& query,
                                        const Pose& T_query_reference, double voxel_size = 0.5);

/// The same with the query's voxels at hand.
[[nodiscard]] double volumetric_overlap(const Points& reference, const VoxelLevel& query,
                                        const Pose& T_query_reference);

}  // namespace groundloop
