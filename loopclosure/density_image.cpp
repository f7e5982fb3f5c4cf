#include "loopclosure/density_image.hpp"

#include <algorithm>
#include <cmath>

namespace groundloop {
namespace {

constexpr std::uint32_t kLargestCount = 1U << 20;  // greater counts are one

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
  const PoseF T(T_ground_map);
  const auto inverse = static_cast<float>(1.0 / options.resolution);
  const auto half = static_cast<float>(grid.half), side = static_cast<float>(grid.side);
  const Eigen::Matrix<float, 2, 3> R = T.rotation.topRows<2>() * inverse;
  // Cells are counted from the corner of the grid, so that truncation is the floor.
  const Eigen::Vector2f t = T.translation.head<2>() * inverse + Eigen::Vector2f(half, half);
  int low_u = grid.side, low_v = grid.side, high_u = -1, high_v = -1;
  for (const Eigen::Vector3f& p : points) {
    const float x = R(0, 0) * p.x() + R(0, 1) * p.y() + R(0, 2) * p.z() + t.x();
    const float y = R(1, 0) * p.x() + R(1, 1) * p.y() + R(1, 2) * p.z() + t.y();
    // Written so that NaN fails.
    if (!(x >= 0 && x < side && y >= 0 && y < side)) {
      ++grid.dropped;
      continue;
    }
    const int u = static_cast<int>(x), v = static_cast<int>(y);
    ++grid.counts[static_cast<std::size_t>(v) * static_cast<std::size_t>(grid.side) +
                  static_cast<std::size_t>(u)];
    low_u = std::min(low_u, u), high_u = std::max(high_u, u);
    low_v = std::min(low_v, v), high_v = std::max(high_v, v);
  }
  grid.low = Eigen::Vector2i(low_u - grid.half, low_v - grid.half);
  grid.high = Eigen::Vector2i(high_u - grid.half, high_v - grid.half);
  return grid;
}

// The count that a share of the occupied cells does not exceed, rounded towards the greatest.
std::size_t quantile(const std::vector<std::size_t>& histogram, std::size_t occupied,
                     double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(occupied - 1)));
  std::size_t below = 0;
  for (std::size_t count = 0; count < histogram.size(); ++count) {
    below += histogram[count];
    if (below > rank) return count;
  }
  return histogram.size() - 1;
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
  std::uint32_t least = 0xffffffffU;
  std::size_t occupied = 0;
  std::vector<std::size_t> histogram;
  for (int v = 0; v < image.height; ++v) {
    const std::uint32_t* counts = row(v);
    for (int u = 0; u < image.width; ++u) {
      if (counts[u] == 0) continue;
      least = std::min(least, counts[u]);
      const std::size_t bin = std::min(counts[u], kLargestCount);
      if (bin >= histogram.size()) histogram.resize(bin + 1, 0);
      ++histogram[bin];
      ++occupied;
    }
  }
  const double range =
      static_cast<double>(quantile(histogram, occupied, options.saturation)) - least;
  image.pixels.assign(
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 0);
  for (int v = 0; v < image.height; ++v) {
    const std::uint32_t* counts = row(v);
    std::uint8_t* pixels = image.pixels.data() + static_cast<std::ptrdiff_t>(v) * image.width;
    for (int u = 0; u < image.width; ++u) {
      if (counts[u] == 0) continue;
      const double density =
          range > 0 ? std::min(1.0, (static_cast<double>(counts[u]) - least) / range) : 1.0;
      if (density >= options.min_density) {
        pixels[u] = static_cast<std::uint8_t>(std::lround(255.0 * density));
      }
    }
  }
  return image;
}

}  // namespace groundloop
