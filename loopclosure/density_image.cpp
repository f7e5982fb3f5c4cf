#include "loopclosure/density_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "loopclosure/wide.hpp"

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
  // Cells from row to row. Not a power of two: rows would share few lines of the nearest cache.
  std::ptrdiff_t stride = 0;
  std::vector<std::uint32_t> counts;  // of layers: first as bits
  Eigen::Vector2i low, high;          // occupied cells, both included, from the corner of the grid
  std::size_t dropped = 0;

  [[nodiscard]] std::uint32_t* row(int v) { return counts.data() + v * stride; }
};

// A thread's grid: megabytes that would otherwise be allocated and zeroed for every map.
CountGrid& clean_grid(const DensityImageOptions& options) {
  thread_local CountGrid grid;
  const int half = static_cast<int>(std::ceil(options.max_extent / options.resolution));
  if (grid.half != half) {
    grid.half = half;
    grid.side = 2 * half;
    grid.stride = grid.side + 16;
    grid.counts.assign(static_cast<std::size_t>(grid.side) * static_cast<std::size_t>(grid.stride),
                       0);
  }
  grid.dropped = 0;
  return grid;
}

// Where the points of a block lie: the cell's index in the grid (-1 outside of it) and their layer
// as a bit; and the cells they occupy.
struct Block {
  static constexpr std::size_t kPoints = 128;
  std::array<std::int32_t, kPoints> cell;
  std::array<std::uint32_t, kPoints> layer;
  std::int32_t low_u, high_u, low_v, high_v;
};

// Ground frame in cells and layers, counted from the corner of the grid and the lowest layer, so
// that truncation is the floor.
struct CellTransform {
  Eigen::Matrix3f R;
  Eigen::Vector3f t;
  std::int32_t side, stride;
};

// Without branches, so that it runs several points at a time.
GROUNDLOOP_WIDE void locate(const CellTransform& T, const Eigen::Vector3f* points,
                            std::size_t count, Block& block) {
  const float* const values = points->data();
  const float r00 = T.R(0, 0), r01 = T.R(0, 1), r02 = T.R(0, 2), r10 = T.R(1, 0), r11 = T.R(1, 1),
              r12 = T.R(1, 2), r20 = T.R(2, 0), r21 = T.R(2, 1), r22 = T.R(2, 2), tx = T.t.x(),
              ty = T.t.y(), tz = T.t.z(), end = static_cast<float>(T.side);
  const std::int32_t side = T.side, stride = T.stride;
  std::int32_t low_u = side, high_u = -1, low_v = side, high_v = -1;
  for (std::size_t i = 0; i < count; ++i) {
    const float px = values[3 * i], py = values[3 * i + 1], pz = values[3 * i + 2];
    const float x = r00 * px + r01 * py + r02 * pz + tx;
    const float y = r10 * px + r11 * py + r12 * pz + ty;
    const float height = r20 * px + r21 * py + r22 * pz + tz;
    // Written so that NaN is outside.
    const float above_u = x >= 0.0F ? x : -1.0F, above_v = y >= 0.0F ? y : -1.0F;
    const auto u = static_cast<std::int32_t>(above_u < end ? above_u : -1.0F);
    const auto v = static_cast<std::int32_t>(above_v < end ? above_v : -1.0F);
    const float above = height > 0.0F ? height : 0.0F;
    const auto layer = static_cast<std::int32_t>(above < kLayers - 1.0F ? above : kLayers - 1.0F);
    const bool inside = (u | v) >= 0;
    block.cell[i] = inside ? v * stride + u : -1;
    block.layer[i] = 1U << layer;
    const std::int32_t least_u = inside ? u : side, least_v = inside ? v : side;
    const std::int32_t most_u = inside ? u : -1, most_v = inside ? v : -1;
    low_u = least_u < low_u ? least_u : low_u;
    low_v = least_v < low_v ? least_v : low_v;
    high_u = most_u > high_u ? most_u : high_u;
    high_v = most_v > high_v ? most_v : high_v;
  }
  block.low_u = low_u, block.high_u = high_u, block.low_v = low_v, block.high_v = high_v;
}

template <bool kCountLayers>
void count_points(const Points& points, const Pose& T_ground_map,
                  const DensityImageOptions& options, CountGrid& grid) {
  const PoseF T(T_ground_map);
  const Eigen::Vector3f scale =
      Eigen::Vector3d(1 / options.resolution, 1 / options.resolution, 1 / options.layer_height)
          .cast<float>();
  const auto half = static_cast<float>(grid.half);
  const CellTransform to_cells{
      scale.asDiagonal() * T.rotation,
      scale.cwiseProduct(T.translation) + Eigen::Vector3f(half, half, kGroundLayer), grid.side,
      static_cast<std::int32_t>(grid.stride)};
  std::uint32_t* const counts = grid.counts.data();
  grid.low = Eigen::Vector2i::Constant(grid.side);
  grid.high = Eigen::Vector2i::Constant(-1);
  Block block;
  for (std::size_t begin = 0; begin < points.size(); begin += Block::kPoints) {
    const std::size_t count = std::min(Block::kPoints, points.size() - begin);
    // Maps are larger than the nearer caches, and the processor's own reading ahead ends at pages.
    constexpr std::size_t kAhead = 4 * Block::kPoints, kPointsALine = 5;
    if (begin + kAhead + Block::kPoints <= points.size()) {
      const Eigen::Vector3f* const ahead = points.data() + begin + kAhead;
      for (std::size_t i = 0; i < Block::kPoints; i += kPointsALine) __builtin_prefetch(ahead + i);
    }
    locate(to_cells, points.data() + begin, count, block);
    grid.low = grid.low.cwiseMin(Eigen::Vector2i(block.low_u, block.low_v));
    grid.high = grid.high.cwiseMax(Eigen::Vector2i(block.high_u, block.high_v));
    for (std::size_t i = 0; i < count; ++i) {
      if (block.cell[i] < 0) {
        ++grid.dropped;
        continue;
      }
      std::uint32_t& cell = counts[block.cell[i]];
      if constexpr (kCountLayers) {
        cell |= block.layer[i];
      } else {
        ++cell;
      }
    }
  }
}

// How many occupied cells there are of each count.
struct Histogram {
  std::vector<std::size_t> cells;
  std::size_t occupied = 0;
};

// Replaces each value by the number of its bits, several at a time.
GROUNDLOOP_WIDE void count_bits(std::uint32_t* values, int count) {
  for (int i = 0; i < count; ++i) {
    std::uint32_t x = values[i];
    x -= (x >> 1) & 0x55555555U;
    x = (x & 0x33333333U) + ((x >> 2) & 0x33333333U);
    x = (x + (x >> 4)) & 0x0f0f0f0fU;
    x += x >> 8;
    values[i] = (x + (x >> 16)) & 0x3fU;
  }
}

// Turns the bits of the occupied part of the grid into counts of layers.
Histogram layer_histogram(CountGrid& grid) {
  // Most cells are empty: with one bin for them, each increment would wait for the one before.
  constexpr int kParts = 4;
  std::array<std::array<std::uint32_t, kLayers + 1>, kParts> parts{};
  const int width = grid.high.x() - grid.low.x() + 1;
  for (int v = grid.low.y(); v <= grid.high.y(); ++v) {
    std::uint32_t* const row = grid.row(v) + grid.low.x();
    count_bits(row, width);
    int u = 0;
    for (; u + kParts <= width; u += kParts) {
      for (int part = 0; part < kParts; ++part) {
        ++parts[static_cast<std::size_t>(part)][row[u + part]];
      }
    }
    for (; u < width; ++u) ++parts[0][row[u]];
  }
  Histogram histogram;
  histogram.cells.resize(kLayers + 1);
  for (std::size_t bin = 1; bin <= kLayers; ++bin) {
    for (const auto& part : parts) histogram.cells[bin] += part[bin];
    histogram.occupied += histogram.cells[bin];
  }
  return histogram;
}

Histogram point_histogram(CountGrid& grid) {
  Histogram histogram;
  for (int v = grid.low.y(); v <= grid.high.y(); ++v) {
    std::uint32_t* const row = grid.row(v);
    for (int u = grid.low.x(); u <= grid.high.x(); ++u) {
      if (row[u] == 0) continue;
      row[u] = std::min(row[u], kLargestCount);
      if (row[u] >= histogram.cells.size()) histogram.cells.resize(row[u] + 1, 0);
      ++histogram.cells[row[u]];
      ++histogram.occupied;
    }
  }
  return histogram;
}

// The count that a share of the occupied cells does not exceed, rounded towards the greatest.
std::size_t quantile(const Histogram& histogram, double share) {
  const auto rank =
      static_cast<std::size_t>(std::ceil(share * static_cast<double>(histogram.occupied - 1)));
  std::size_t below = 0;
  for (std::size_t count = 0; count < histogram.cells.size(); ++count) {
    below += histogram.cells[count];
    if (below > rank) return count;
  }
  return histogram.cells.size() - 1;
}

// The grey level of each count.
std::vector<std::uint8_t> grey_levels(const Histogram& histogram,
                                      const DensityImageOptions& options) {
  std::size_t least = 0;
  while (histogram.cells[least] == 0) ++least;
  const double range = static_cast<double>(quantile(histogram, options.saturation) - least);
  std::vector<std::uint8_t> levels(histogram.cells.size(), 0);
  for (std::size_t count = least; count < levels.size(); ++count) {
    const double density =
        range > 0 ? std::min(1.0, static_cast<double>(count - least) / range) : 1.0;
    if (density < options.min_density) continue;
    levels[count] = static_cast<std::uint8_t>(std::lround(255.0 * density));
  }
  return levels;
}

}  // namespace

DensityImage make_density_image(const Points& map_points, const Pose& T_ground_map,
                                const DensityImageOptions& options) {
  CountGrid& grid = clean_grid(options);
  const bool layers = options.count == "layers";
  if (layers) {
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
  const std::vector<std::uint8_t> levels =
      grey_levels(layers ? layer_histogram(grid) : point_histogram(grid), options);
  image.pixels.resize(static_cast<std::size_t>(image.width) *
                      static_cast<std::size_t>(image.height));
  for (int v = 0; v < image.height; ++v) {
    std::uint32_t* const counts = grid.row(grid.low.y() + v) + grid.low.x();
    std::uint8_t* const pixels = image.pixels.data() + static_cast<std::ptrdiff_t>(v) * image.width;
    for (int u = 0; u < image.width; ++u) pixels[u] = levels[counts[u]];
    // The grid is left as it was found.
    std::fill(counts, counts + image.width, 0U);
  }
  return image;
}

}  // namespace groundloop
