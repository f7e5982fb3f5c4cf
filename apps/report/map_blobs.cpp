#include "apps/report/map_blobs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

// Chunks of so many points are unpacked one by one, so that the page shows the coarse ones at once.
constexpr std::size_t kChunk = 65'536;
constexpr float kUnit = 0.01F;  // m, where 16 bits reach across the node

float unit_of(const OctreeNode& node) { return std::max(kUnit, node.edge / 65'000.0F); }

std::uint16_t zigzag(std::int32_t difference) {
  const auto wrapped = static_cast<std::int16_t>(difference);
  return static_cast<std::uint16_t>((wrapped << 1) ^ (wrapped >> 15));
}

// x of all points of the chunk, then y, then z; each the difference from the point before in its
// node, modulo 2^16.
std::vector<std::uint16_t> places(const PointOctree& tree, std::span<const OctreeNode> nodes) {
  std::vector<std::uint16_t> values;
  for (int axis = 0; axis < 3; ++axis) {
    for (const OctreeNode& node : nodes) {
      std::int32_t before = 0;
      for (std::size_t i = node.first; i < node.first + node.count; ++i) {
        const float inside = (tree.points[i].position[axis] - node.corner[axis]) / unit_of(node);
        const auto place = static_cast<std::int32_t>(std::clamp(std::lround(inside), 0L, 65'535L));
        values.push_back(zigzag(place - before));
        before = place;
      }
    }
  }
  return values;
}

// 0: no surface; else 1 to 255 for the square root of 0 to 0.5 m.
std::uint8_t packed(float thickness) {
  if (!(thickness >= 0.0F)) return 0;
  return static_cast<std::uint8_t>(
      1 + std::lround(254.0F * std::sqrt(std::min(thickness, 0.5F) / 0.5F)));
}

Json chunk_json(const FrameView& view, std::span<const OctreeNode> nodes, Blobs& blobs) {
  const PointOctree& tree = view.octree;
  std::vector<std::uint32_t> rows;
  std::vector<std::uint8_t> thickness;
  std::uint32_t before = 0;
  for (const OctreeNode& node : nodes) {
    for (std::size_t i = node.first; i < node.first + node.count; ++i) {
      rows.push_back(tree.points[i].row - before);  // modulo 2^32
      before = tree.points[i].row;
      thickness.push_back(packed(view.thickness[i]));
    }
  }
  const std::vector<std::uint16_t> place = places(tree, nodes);
  return {{"nodes", nodes.size()},
          {"points", rows.size()},
          {"place", blobs.add(std::span<const std::uint16_t>(place))},
          {"row", blobs.add(std::span<const std::uint32_t>(rows))},
          {"thickness", blobs.add(std::span<const std::uint8_t>(thickness))}};
}

}  // namespace

Json map_blobs(const FrameView& view, Blobs& blobs) {
  const PointOctree& tree = view.octree;
  std::vector<float> table;
  for (const OctreeNode& node : tree.nodes) {
    table.insert(table.end(),
                 {static_cast<float>(node.level), node.edge, node.corner.x(), node.corner.y(),
                  node.corner.z(), unit_of(node), static_cast<float>(node.count)});
  }
  Json chunks = Json::array();
  std::size_t first = 0;
  while (first < tree.nodes.size()) {
    std::size_t last = first;
    std::size_t points = 0;
    while (last < tree.nodes.size() && (points == 0 || points + tree.nodes[last].count <= kChunk))
      points += tree.nodes[last++].count;
    chunks.push_back(chunk_json(view, std::span(tree.nodes).subspan(first, last - first), blobs));
    first = last;
  }
  return {{"count", tree.points.size()},
          {"spacing", tree.levels > 0 ? tree.spacing(tree.levels - 1) : 0.0F},
          {"levels", tree.levels},
          {"nodes", blobs.add(std::span<const float>(table))},
          {"chunks", chunks}};
}

}  // namespace groundloop::apps
