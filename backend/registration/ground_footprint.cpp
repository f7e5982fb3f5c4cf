#include "backend/registration/ground_footprint.hpp"

#include <algorithm>

#include "frontend/core/voxel_table.hpp"

namespace groundloop {
namespace {

constexpr float kCell = 8.0F;

}  // namespace

GroundFootprint ground_footprint(const Points& map_points) {
  VoxelTable table(4096);
  GroundFootprint footprint;
  for (const Eigen::Vector3f& p : map_points) {
    const Eigen::Vector3i voxel = voxel_of(p, 1.0F / kCell);
    const auto index = static_cast<std::uint32_t>(footprint.cells.size());
    if (table.find_or_insert(voxel_key(voxel), index) != index) continue;
    footprint.cells.emplace_back((voxel.cast<float>().array() + 0.5F) * kCell);
    footprint.radius = std::max(footprint.radius, footprint.cells.back().norm() + kCell);
  }
  return footprint;
}

double footprint_overlap(const GroundFootprint& reference, const GroundFootprint& query,
                         const Pose& T_query_reference) {
  if (reference.cells.empty() || query.cells.empty()) return 0.0;
  if (T_query_reference.translation.norm() > static_cast<double>(reference.radius + query.radius))
    return 0.0;
  VoxelTable table(query.cells.size());
  for (std::uint32_t i = 0; i < query.cells.size(); ++i) {
    table.find_or_insert(voxel_key(voxel_of(query.cells[i], 1.0F / kCell)), i);
  }
  const PoseF T(T_query_reference);
  std::size_t shared = 0;
  for (const Eigen::Vector3f& cell : reference.cells) {
    if (table.find(voxel_key(voxel_of(T * cell, 1.0F / kCell))) != VoxelTable::kNone) ++shared;
  }
  return static_cast<double>(shared) /
         static_cast<double>(std::min(reference.cells.size(), query.cells.size()));
}

}  // namespace groundloop
