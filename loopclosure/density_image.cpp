#include "loopclosure/density_image.hpp"

#include <algorithm>
#include <cmath>

namespace groundloop {
namespace {

// Counts on a square grid about the ground frame's origin, filled in one pass.
struct CountGrid {
  int half = 0;  // cells from the origin to the border
  int side = 0;
  std::vector<std::uint32_t> counts;
  Eigen::Vector2i low, high;  // occupied cells, both included
  std::size_t dropped = 0;
};

CountGrid count_points(const Points& points, const Pose& T_ground_map,
                       const DensityImageOptions& options) {
  CountGrid grid;
  grid.half = static_cast<int>(std::ceil(options.max_extent / options.resolution));
  grid.side = 2 * grid.half;
  grid.counts.assign(static_cast<std::size_t>(grid.side) * static_cast<std::size_t>(grid.side), 0);
  grid.low.setConstant(grid.half);
  grid.high.setConstant(-grid.half - 1);
  const PoseF T(T_ground_map);
  const auto inverse = static_cast<float>(1.0 / options.resolution);
  const Eigen::Matrix<float, 2, 3> R = T.rotation.topRows<2>() * inverse;
  const Eigen::Vector2f t = T.translation.head<2>() * inverse;
  const auto bound = static_cast<float>(grid.half);
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector2f cell = R * p + t;
    // Written so that NaN fails.
    if (!(cell.x() >= -bound && cell.x() < bound && cell.y() >= -bound && cell.y() < bound)) {
      ++grid.dropped;
      continue;
    }
    const Eigen::Vector2i c(static_cast<int>(std::floor(cell.x())),
                            static_cast<int>(std::floor(cell.y())));
    ++grid.counts[static_cast<std::size_t>(c.y() + grid.half) *
                      static_cast<std::size_t>(grid.side) +
                  static_cast<std::size_t>(c.x() + grid.half)];
    grid.low = grid.low.cwiseMin(c);
    grid.high = grid.high.cwiseMax(c);
  }
  return grid;
}

}  // namespace

DensityImage make_density_image(const Points& map_points, const Pose& T_ground_map,
                                const DensityImageOptions& options) {
  const CountGrid grid = count_points(map_points, T_ground_map, options);
  DensityImage image;
  image.resolution = options.resolution;
  image.dropped_points = grid.dropped;
  if (grid.high.x() < grid.low.x()) return image;

  image.first_cell = grid.low;
  image.width = grid.high.x() - grid.low.x() + 1;
  image.height = grid.high.y() - grid.low.y() + 1;
  const auto row = [&](int v) {
    return grid.counts.data() +
           static_cast<std::ptrdiff_t>(grid.low.y() + v + grid.half) * grid.side + grid.low.x() +
           grid.half;
  };
  std::uint32_t least = 0xffffffffU, greatest = 0;
  for (int v = 0; v < image.height; ++v) {
    const std::uint32_t* counts = row(v);
    for (int u = 0; u < image.width; ++u) {
      if (counts[u] == 0) continue;
      least = std::min(least, counts[u]);
      greatest = std::max(greatest, counts[u]);
    }
  }
  image.pixels.assign(
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 0);
  const double range = static_cast<double>(greatest) - static_cast<double>(least);
  for (int v = 0; v < image.height; ++v) {
    const std::uint32_t* counts = row(v);
    std::uint8_t* pixels = image.pixels.data() + static_cast<std::ptrdiff_t>(v) * image.width;
    for (int u = 0; u < image.width; ++u) {
      if (counts[u] == 0) continue;
      const double density =
          range > 0 ? (static_cast<double>(counts[u]) - static_cast<double>(least)) / range : 1.0;
      if (density >= options.min_density) {
        pixels[u] = static_cast<std::uint8_t>(std::lround(255.0 * density));
      }
    }
  }
  return image;
}

}  // namespace groundloop
