#include "loopclosure/density_image.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace groundloop {
namespace {

constexpr std::uint32_t kLargestCount = 1U << 20;  // greater counts are one
// The ground, to within half a layer, is one layer; two lie below it, and the outermost take what
// is beyond them.
constexpr int kLayers = 32;
constexpr float kGroundLayer = 2.5F;

// Counts on a square grid about the ground frame's origin, filled in one pass.
struct CountGrid {
  int half = 0;  // cells from the origin to the border
  int side = 0;
  std::vector<std::uint32_t> counts;  // of layers: first as bits
  Eigen::Vector2i low, high;          // occupied cells, both included, from the corner of the grid
  std::size_t dropped = 0;

  [[nodiscard]] std::uint32_t* row(int v) {
    return counts.data() + static_cast<std::ptrdiff_t>(v) * side;
  }
  // As before the first point; only what was occupied is touched.
  void clear() {
    for (int v = low.y(); v <= high.y(); ++v)
      std::fill(row(v) + low.x(), row(v) + high.x() + 1, 0U);
  }
};

// A thread's grid: megabytes that would otherwise be allocated and zeroed for every map.
CountGrid& clean_grid(const DensityImageOptions& options) {
  thread_local CountGrid grid;
  const int half = static_cast<int>(std::ceil(options.max_extent / options.resolution));
  if (grid.half != half) {
    grid.half = half;
    grid.side = 2 * half;
    grid.counts.assign(static_cast<std::size_t>(grid.side) * static_cast<std::size_t>(grid.side),
                       0);
  }
  grid.dropped = 0;
  return grid;
}

template <bool kCountLayers>
void count_points(const Points& points, const Pose& T_ground_map,
                  const DensityImageOptions& options, CountGrid& grid) {
  const PoseF T(T_ground_map);
  const auto side = static_cast<float>(grid.side);
  // Cells are counted from the corner of the grid, so that truncation is the floor.
  const Eigen::Vector3f scale =
      Eigen::Vector3d(1 / options.resolution, 1 / options.resolution, 1 / options.layer_height)
          .cast<float>();
  const Eigen::Matrix3f R = scale.asDiagonal() * T.rotation;
  const auto half = static_cast<float>(grid.half);
  const Eigen::Vector3f t =
      scale.cwiseProduct(T.translation) + Eigen::Vector3f(half, half, kGroundLayer);
  std::uint32_t* const counts = grid.counts.data();
  const auto stride = static_cast<std::ptrdiff_t>(grid.side);
  std::size_t dropped = 0;
  int low_u = grid.side, low_v = grid.side, high_u = -1, high_v = -1;
  for (const Eigen::Vector3f& p : points) {
    const float x = R(0, 0) * p.x() + R(0, 1) * p.y() + R(0, 2) * p.z() + t.x();
    const float y = R(1, 0) * p.x() + R(1, 1) * p.y() + R(1, 2) * p.z() + t.y();
    // Written so that NaN fails.
    if (!(x >= 0 && x < side && y >= 0 && y < side)) {
      ++dropped;
      continue;
    }
    const int u = static_cast<int>(x), v = static_cast<int>(y);
    std::uint32_t& count = counts[v * stride + u];
    if constexpr (kCountLayers) {
      const float layer = R(2, 0) * p.x() + R(2, 1) * p.y() + R(2, 2) * p.z() + t.z();
      count |= 1U << static_cast<int>(std::clamp(layer, 0.0F, kLayers - 1.0F));
    } else {
      ++count;
    }
    low_u = std::min(low_u, u), high_u = std::max(high_u, u);
    low_v = std::min(low_v, v), high_v = std::max(high_v, v);
  }
  grid.dropped = dropped;
  grid.low = Eigen::Vector2i(low_u, low_v);
  grid.high = Eigen::Vector2i(high_u, high_v);
  if constexpr (kCountLayers) {
    for (int v = low_v; v <= high_v; ++v) {
      std::uint32_t* row = grid.row(v);
      for (int u = low_u; u <= high_u; ++u) {
        if (row[u] != 0) row[u] = static_cast<std::uint32_t>(std::popcount(row[u]));
      }
    }
  }
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
  CountGrid& grid = clean_grid(options);
  if (options.count == "layers") {
    count_points<true>(map_points, T_ground_map, options, grid);
  } else {
    count_points<false>(map_points, T_ground_map, options, grid);
  }
  DensityImage image;
  image.resolution = options.resolution;
  image.dropped_points = grid.dropped;
  if (grid.high.x() < grid.low.x()) return image;

  image.first_cell = grid.low.array() - grid.half;
  image.width = grid.high.x() - grid.low.x() + 1;
  image.height = grid.high.y() - grid.low.y() + 1;
  const auto row = [&](int v) { return grid.row(grid.low.y() + v) + grid.low.x(); };
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
  grid.clear();
  return image;
}

}  // namespace groundloop
