#include "apps/report/point_octree.hpp"

#include <algorithm>
#include <utility>

#include "frontend/core/voxel_table.hpp"

namespace groundloop::apps {
namespace {

// A node is as many spacings wide: of a surface it holds some thousand points.
constexpr int kSpacingsPerNode = 64;
// A level with fewer points is worth no coarser one.
constexpr std::size_t kCoarsest = 4096;

using Indices = std::vector<std::uint32_t>;

// Of the points `among`, one for each voxel of `size`: the nearest to its centre, the first of
// equals.
Indices promote(const std::vector<MapPoint>& points, const Indices& among, float size) {
  VoxelTable table(among.size() / 2);
  Indices promoted;
  std::vector<float> distances;
  for (const std::uint32_t i : among) {
    const Eigen::Vector3f& p = points[i].position;
    const Eigen::Vector3i voxel = voxel_of(p, 1.0F / size);
    const float distance = (p - (voxel.cast<float>().array() + 0.5F).matrix() * size).squaredNorm();
    const auto next = static_cast<std::uint32_t>(promoted.size());
    const std::uint32_t found = table.find_or_insert(voxel_key(voxel), next);
    if (found == next) {
      promoted.push_back(i);
      distances.push_back(distance);
    } else if (distance < distances[found]) {
      promoted[found] = i;
      distances[found] = distance;
    }
  }
  return promoted;
}

// How often each point was promoted, and how often any was.
std::vector<std::uint8_t> heights(const std::vector<MapPoint>& points, float spacing, int& most) {
  std::vector<std::uint8_t> height(points.size(), 0);
  Indices remaining(points.size());
  for (std::size_t i = 0; i < remaining.size(); ++i) remaining[i] = static_cast<std::uint32_t>(i);
  most = 0;
  while (remaining.size() > kCoarsest && most < 24) {
    spacing *= 2.0F;
    ++most;
    remaining = promote(points, remaining, spacing);
    for (const std::uint32_t i : remaining) height[i] = static_cast<std::uint8_t>(most);
  }
  return height;
}

// A well-mixed number of an index: the same points are left out whatever the machine.
std::uint32_t mixed(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352dU;
  x = (x ^ (x >> 15)) * 0x846ca68bU;
  return x ^ (x >> 16);
}

// All points of the coarser levels, and of the finest as many as there is room for.
std::vector<bool> keep_at_most(const std::vector<std::uint8_t>& height, std::size_t most) {
  std::vector<bool> kept(height.size(), true);
  Indices finest;
  for (std::uint32_t i = 0; i < height.size(); ++i) {
    if (height[i] == 0) finest.push_back(i);
  }
  const std::size_t coarser = height.size() - finest.size();
  const std::size_t room = most > coarser ? most - coarser : 0;
  if (room >= finest.size()) return kept;
  const auto end = finest.begin() + static_cast<std::ptrdiff_t>(room);
  std::nth_element(finest.begin(), end, finest.end(), [](std::uint32_t a, std::uint32_t b) {
    return std::pair(mixed(a), a) < std::pair(mixed(b), b);
  });
  for (auto i = end; i != finest.end(); ++i) kept[*i] = false;
  return kept;
}

// Every third bit of the result is one of v.
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

struct Placed {
  int level;
  VoxelKey cube;
  std::uint64_t morton;
  std::uint32_t index;
  friend auto operator<=>(const Placed&, const Placed&) = default;
};

Placed place(const MapPoint& point, std::uint32_t index, int level, float spacing) {
  const float edge = kSpacingsPerNode * spacing;
  const Eigen::Vector3i cube = voxel_of(point.position, 1.0F / edge);
  const Eigen::Vector3f inside =
      (point.position - cube.cast<float>() * edge).cwiseMax(0.0F) / edge * 1024.0F;
  const auto cell = [&](int axis) { return spread(static_cast<std::uint64_t>(inside[axis])); };
  return {level, voxel_key(cube), cell(0) | cell(1) << 1 | cell(2) << 2, index};
}

}  // namespace

float PointOctree::spacing(int level) const {
  return coarsest_spacing / static_cast<float>(1 << level);
}

PointOctree build_octree(const std::vector<MapPoint>& points, float spacing, std::size_t most) {
  PointOctree tree;
  int highest = 0;
  const std::vector<std::uint8_t> height = heights(points, spacing, highest);
  tree.levels = points.empty() ? 0 : highest + 1;
  tree.coarsest_spacing = spacing * static_cast<float>(1 << highest);
  std::vector<Placed> placed;
  placed.reserve(points.size());
  const std::vector<bool> kept = keep_at_most(height, most);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!kept[i]) continue;
    const int level = highest - height[i];
    placed.push_back(place(points[i], i, level, tree.spacing(level)));
  }
  std::sort(placed.begin(), placed.end());
  tree.points.reserve(placed.size());
  for (const Placed& p : placed) {
    if (tree.nodes.empty() || tree.nodes.back().level != p.level ||
        placed[tree.nodes.back().first].cube != p.cube) {
      const float edge = kSpacingsPerNode * tree.spacing(p.level);
      tree.nodes.push_back(
          {p.level, edge, voxel_from_key(p.cube).cast<float>() * edge, tree.points.size(), 0});
    }
    ++tree.nodes.back().count;
    tree.points.push_back(points[p.index]);
  }
  return tree;
}

}  // namespace groundloop::apps
