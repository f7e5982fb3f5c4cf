#include "backend/registration/overlap.hpp"

#include <algorithm>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// Keys of the voxels that points come to lie in; kNoKey for those that have none.
constexpr VoxelKey kNoKey = ~VoxelKey{0};

std::vector<VoxelKey> keys_of(const Points& points, const Pose& T_query_points, float voxel_size) {
  const PoseF T(T_query_points);
  const float inverse = 1.0F / voxel_size;
  std::vector<VoxelKey> keys(points.size());
  parallel_for(points.size(), 4096, [&](std::size_t i) {
    const Eigen::Vector3f moved = T * points[i];
    keys[i] = has_voxel(moved) ? voxel_key(voxel_of(moved, inverse)) : kNoKey;
  });
  return keys;
}

}  // namespace

double volumetric_overlap(const Points& reference, const VoxelLevel& query,
                          const Pose& T_query_reference) {
  VoxelTable occupied(reference.size() / 4);
  std::size_t shared = 0;
  for (const VoxelKey key : keys_of(reference, T_query_reference, query.voxel_size)) {
    if (key == kNoKey) continue;
    const std::size_t before = occupied.size();
    occupied.find_or_insert(key, 0);
    if (occupied.size() > before && query.index.find(key) != VoxelTable::kNone) ++shared;
  }
  const std::size_t smaller = std::min(occupied.size(), query.index.size());
  return smaller == 0 ? 0.0 : static_cast<double>(shared) / static_cast<double>(smaller);
}

double volumetric_overlap(const Points& reference, const Points& query,
                          const Pose& T_query_reference, double voxel_size) {
  VoxelLevel level;
  level.voxel_size = static_cast<float>(voxel_size);
  level.index = VoxelTable(query.size() / 4);
  for (const VoxelKey key : keys_of(query, Pose(), level.voxel_size)) {
    if (key != kNoKey) level.index.find_or_insert(key, 0);
  }
  return volumetric_overlap(reference, level, T_query_reference);
}

}  // namespace groundloop
