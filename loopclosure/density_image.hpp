// The density image (Sec. 3.3): what stands on the cells of a grid on the ground of an aligned
// local map, scaled to eight bits. The paper counts points; here a cell counts the layers of height
// that hold any, so that a place looks the same whatever the LiDAR, the speed and the distance it
// was seen from. Extent and memory are bounded whatever the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

/// Column u and row v count cells along x and y of the ground frame; row-major, not padded.
struct DensityImage {
  int width = 0;
  int height = 0;
  Eigen::Vector2i first_cell =
      Eigen::Vector2i::Zero();  ///< cell of column 0, row 0: floor(x / resolution)
  double resolution = 0.5;      ///< m a pixel
  std::vector<std::uint8_t> pixels;
  std::size_t dropped_points = 0;  ///< not finite, or beyond the greatest extent

  /// Ground-frame metres of a position in pixels, where whole numbers are pixel centres.
  [[nodiscard]] Eigen::Vector2f to_metres(float u, float v) const {
    const auto r = static_cast<float>(resolution);
    return {(u + static_cast<float>(first_cell.x()) + 0.5F) * r,
            (v + static_cast<float>(first_cell.y()) + 0.5F) * r};
  }
};

/// Counts scaled from their least to their greatest over the occupied cells, to 0..255, where the
/// greatest is the quantile options.saturation; pixels of a relative density under
/// options.min_density are zero. Where all counts are equal, occupied cells
/// are full. No usable point: an empty image.
[[nodiscard]] DensityImage make_density_image(const Points& map_points, const Pose& T_ground_map,
                                              const DensityImageOptions& options);

}  // namespace groundloop
