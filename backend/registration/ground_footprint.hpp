// The ground area a local map covers, as a coarse set of cells small enough to keep for every map:
// which pairs of maps can overlap in a solution is asked of footprints, so that only those are read
// from disk.
#pragma once

#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

struct GroundFootprint {
  /// Centres of the occupied voxels of 8 m edge, in the map's frame.
  Points cells;
  float radius = 0.0F;  ///< of the cells around the map's origin, metres
};

[[nodiscard]] GroundFootprint ground_footprint(const Points& map_points);

/// Share of the smaller footprint's voxels that lie in one of the other's with the reference
/// brought into the query map by T_query_reference.
[[nodiscard]] double footprint_overlap(const GroundFootprint& reference,
                                       const GroundFootprint& query, const Pose& T_query_reference);

}  // namespace groundloop
