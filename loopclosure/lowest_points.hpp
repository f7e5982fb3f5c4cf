// Ground alignment as the published code 2.0.2 of the paper has it: the plane through the lowest
// points of large cells, by least squares without normals. It wants maps that are nearly level, and
// sensors above the ground. Kept for comparison.
#pragma once

#include "frontend/core/scan.hpp"
#include "loopclosure/ground_alignment.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

/// Of each cell (options.cell_size) on the map's xy-plane that holds a point below its origin the
/// lowest counts, as long as it lies within a cell's size of the plane; at most twenty steps from
/// the identity. Without such points: the identity, not found.
[[nodiscard]] GroundAlignment plane_of_lowest_points(const Points& map_points,
                                                     const GroundAlignmentOptions& options);

}  // namespace groundloop
