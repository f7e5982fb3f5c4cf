#include "frontend/odometry/voxel_map.hpp"

#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>

#include "frontend/core/binary_io.hpp"

namespace groundloop {
namespace {

// Edge of a patch, in voxels.
constexpr int kPatchEdge = 3;
// A plane is as thin as a tenth of a voxel; a voxel or a patch spans it in both directions.
constexpr float kThickness = 0.1F, kBlockSpread = 0.15F, kPatchSpread = 0.5F;
constexpr float kMinBlockPoints = 6.0F, kMinPatchPoints = 8.0F;
// A point this far off the plane of its patch (standard deviations allowed) is not of that plane.
constexpr float kPatchDistance = 1.5F;

Eigen::Vector3i patch_of(const Eigen::Vector3i& voxel) {
  const auto floor_division = [](int v) {
    return v >= 0 ? v / kPatchEdge : -((kPatchEdge - 1 - v) / kPatchEdge);
  };
  return {floor_division(voxel.x()), floor_division(voxel.y()), floor_division(voxel.z())};
}

}  // namespace

VoxelMap::VoxelMap(float voxel_size)
    : voxel_size_(voxel_size),
      inverse_size_(1.0F / voxel_size),
      min_spacing_squared_(voxel_size * voxel_size / static_cast<float>(kMaxPointsPerVoxel)),
      table_(1 << 15),
      patch_table_(1 << 13) {}

MapAnchor VoxelMap::anchor_at(const Eigen::Vector3d& place) const {
  const auto size = static_cast<double>(voxel_size_);
  MapAnchor anchor;
  anchor.voxel = (place / size).array().round().cast<int>();
  anchor.position = anchor.voxel.cast<double>() * size;
  return anchor;
}

VoxelMap::Neighbor VoxelMap::nearest(const MapAnchor& anchor, const Eigen::Vector3f& p,
                                     float max_distance) const {
  const Eigen::Vector3i cell = voxel_of(p, inverse_size_);
  const Eigen::Vector3i center = anchor.voxel + cell;
  const Eigen::Vector3f offset = p - cell.cast<float>() * voxel_size_;
  const float unreachable = std::nextafter(max_distance * max_distance, INFINITY);
  // Squared distances. What lies outside the 27 voxels is farther than an edge.
  float best = unreachable, second = std::min(unreachable, voxel_size_ * voxel_size_);
  const Block* best_block = nullptr;
  std::size_t best_point = 0;
  Eigen::Vector3i best_step = Eigen::Vector3i::Zero();

  const auto search = [&](const Eigen::Vector3i& step) {
    const std::uint32_t index = table_.find(voxel_key(center + step));
    if (index == VoxelTable::kNone) return;
    const Block& block = blocks_[index];
    const Eigen::Vector3f q = offset - step.cast<float>() * voxel_size_;
    std::array<float, kMaxPointsPerVoxel> d{};
    for (std::size_t i = 0; i < kMaxPointsPerVoxel; ++i) {
      const float dx = block.x[i] - q.x(), dy = block.y[i] - q.y(), dz = block.z[i] - q.z();
      d[i] = dx * dx + dy * dy + dz * dz;
    }
    for (std::size_t i = 0; i < block.count; ++i) {
      if (d[i] < best) {
        second = best;
        best = d[i];
        best_block = &block;
        best_point = i;
        best_step = step;
      } else if (d[i] < second) {
        second = d[i];
      }
    }
  };

  search(Eigen::Vector3i::Zero());
  // Squared distance from p to the slab of the neighbours at -1, 0 and +1 along each axis.
  std::array<std::array<float, 3>, 3> gap{};
  for (int axis = 0; axis < 3; ++axis) {
    const float below = std::max(0.0F, offset(axis));
    const float above = std::max(0.0F, voxel_size_ - offset(axis));
    gap[static_cast<std::size_t>(axis)] = {below * below, 0.0F, above * above};
  }
  for (int dx = 0; dx < 3; ++dx) {
    for (int dy = 0; dy < 3; ++dy) {
      const float gap_xy = gap[0][dx] + gap[1][dy];
      if (gap_xy >= best) {
        second = std::min(second, gap_xy);
        continue;
      }
      for (int dz = 0; dz < 3; ++dz) {
        if (dx == 1 && dy == 1 && dz == 1) continue;
        const float distance = gap_xy + gap[2][dz];
        if (distance >= best) {
          second = std::min(second, distance);
        } else {
          search({dx - 1, dy - 1, dz - 1});
        }
      }
    }
  }
  Neighbor result{Eigen::Vector3f::Zero(), best, {}, 0.0F};
  if (best_block == nullptr) return result;
  result.reach = 0.5F * (std::sqrt(second) - std::sqrt(best));
  const Eigen::Vector3f corner = (cell + best_step).cast<float>() * voxel_size_;
  const Eigen::Vector3f point(best_block->x[best_point], best_block->y[best_point],
                              best_block->z[best_point]);
  result.plane = plane_of(*best_block, center + best_step, point);
  result.plane.point += corner;
  result.point = corner + point;
  return result;
}

Plane VoxelMap::plane_of(const Block& block, const Eigen::Vector3i& voxel,
                         const Eigen::Vector3f& point) const {
  if (block.plane.exists()) return block.plane;
  Plane plane = patches_[block.patch].plane;
  if (!plane.exists()) return {};
  plane.point += patch_center(voxel);
  const float limit = kPatchDistance * kThickness * voxel_size_;
  return std::abs(plane.distance(point)) < limit ? plane : Plane{};
}

void VoxelMap::update_plane(Block& block) const {
  block.count_of_plane = block.count;
  const Eigen::Vector3f origin(block.x[0], block.y[0], block.z[0]);
  PlaneMoments moments;
  for (std::uint32_t i = 0; i < block.count; ++i)
    moments.add(Eigen::Vector3f(block.x[i], block.y[i], block.z[i]) - origin);
  block.plane = fit_plane(moments, origin,
                          {kMinBlockPoints, kThickness * voxel_size_, kBlockSpread * voxel_size_});
}

Eigen::Vector3f VoxelMap::patch_center(const Eigen::Vector3i& voxel) const {
  const Eigen::Vector3i corner = kPatchEdge * patch_of(voxel) - voxel;
  return (corner.cast<float>().array() + 0.5F * kPatchEdge) * voxel_size_;
}

void VoxelMap::update_plane(Patch& patch) const {
  patch.plane = fit_plane(patch.moments, Eigen::Vector3f::Zero(),
                          {kMinPatchPoints, kThickness * voxel_size_, kPatchSpread * voxel_size_});
}

bool VoxelMap::add_to_block(Block& block, const Eigen::Vector3f& p) const {
  if (block.count == kMaxPointsPerVoxel) return false;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const float dx = block.x[i] - p.x(), dy = block.y[i] - p.y(), dz = block.z[i] - p.z();
    if (dx * dx + dy * dy + dz * dz < min_spacing_squared_) return false;
  }
  block.x[block.count] = p.x();
  block.y[block.count] = p.y();
  block.z[block.count] = p.z();
  ++block.count;
  return true;
}

std::uint32_t VoxelMap::block_at(const Eigen::Vector3i& voxel) {
  const VoxelKey key = voxel_key(voxel);
  const auto fresh = free_.empty() ? static_cast<std::uint32_t>(blocks_.size()) : free_.back();
  const std::uint32_t index = table_.find_or_insert(key, fresh);
  if (index != fresh) return index;
  if (free_.empty()) {
    blocks_.emplace_back();
  } else {
    free_.pop_back();
  }
  Block& block = blocks_[index];
  block = Block{};
  block.key = key;
  block.patch = patch_at(voxel);
  ++patches_[block.patch].blocks;
  return index;
}

std::uint32_t VoxelMap::patch_at(const Eigen::Vector3i& voxel) {
  const VoxelKey key = voxel_key(patch_of(voxel));
  const auto fresh =
      free_patches_.empty() ? static_cast<std::uint32_t>(patches_.size()) : free_patches_.back();
  const std::uint32_t index = patch_table_.find_or_insert(key, fresh);
  if (index != fresh) return index;
  if (free_patches_.empty()) {
    patches_.emplace_back();
  } else {
    free_patches_.pop_back();
  }
  Patch& patch = patches_[index];
  patch = Patch{};
  patch.key = key;
  return index;
}

void VoxelMap::insert(const Points& points, const Pose& T_world_scan) {
  const MapAnchor anchor = anchor_at(T_world_scan.translation);
  const PoseF T(anchor.inside(T_world_scan));
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f moved = T * point;
    const Eigen::Vector3i cell = voxel_of(moved, inverse_size_);
    const Eigen::Vector3i voxel = anchor.voxel + cell;
    const Eigen::Vector3f p = moved - cell.cast<float>() * voxel_size_;
    const std::uint32_t index = block_at(voxel);
    Block& block = blocks_[index];
    Patch& patch = patches_[block.patch];
    // The first point that either gains in this call lists it.
    if (add_to_block(block, p) && block.count == block.count_of_plane + 1) {
      touched_.push_back(index);
    }
    if (patch.touched == 0) touched_patches_.push_back(block.patch);
    patch.touched = 1;
    patch.moments.add(p - patch_center(voxel));
  }
  for (const std::uint32_t index : touched_) update_plane(blocks_[index]);
  touched_.clear();
  for (const std::uint32_t index : touched_patches_) {
    update_plane(patches_[index]);
    patches_[index].touched = 0;
  }
  touched_patches_.clear();
}

void VoxelMap::remove_beyond(const Eigen::Vector3d& center, float distance) {
  const MapAnchor anchor = anchor_at(center);
  const float limit = distance * distance * inverse_size_ * inverse_size_;
  for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
    Block& block = blocks_[i];
    if (block.count == 0) continue;
    const Eigen::Vector3i step = voxel_step(block.key, voxel_key(anchor.voxel));
    if (step.cast<float>().squaredNorm() <= limit) continue;
    table_.erase(block.key);
    block.count = 0;
    Patch& patch = patches_[block.patch];
    if (--patch.blocks == 0) {
      patch_table_.erase(patch.key);
      free_patches_.push_back(block.patch);
    }
    free_.push_back(i);
  }
}

void VoxelMap::clear() {
  table_.clear();
  blocks_.clear();
  free_.clear();
  patch_table_.clear();
  patches_.clear();
  free_patches_.clear();
}

void VoxelMap::save(std::ostream& out) const {
  put_all(out, blocks_);
  put_all(out, free_);
  put_all(out, patches_);
  put_all(out, free_patches_);
}

void VoxelMap::load(std::istream& in) {
  get_all(in, blocks_);
  get_all(in, free_);
  get_all(in, patches_);
  get_all(in, free_patches_);
  table_.clear();
  patch_table_.clear();
  for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].count > 0) table_.find_or_insert(blocks_[i].key, i);
  }
  for (std::uint32_t i = 0; i < patches_.size(); ++i) {
    if (patches_[i].blocks > 0) patch_table_.find_or_insert(patches_[i].key, i);
  }
  if (!consistent()) in.setstate(std::ios::failbit);
}

bool VoxelMap::consistent() const {
  std::vector<std::uint32_t> blocks_of(patches_.size(), 0);
  std::size_t used = 0, used_patches = 0;
  for (const Block& block : blocks_) {
    if (block.count == 0) continue;
    if (block.count > kMaxPointsPerVoxel || block.patch >= patches_.size()) return false;
    ++blocks_of[block.patch];
    ++used;
  }
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    if (blocks_of[i] != patches_[i].blocks) return false;
    used_patches += patches_[i].blocks > 0;
  }
  const auto free_block = [&](std::uint32_t i) {
    return i < blocks_.size() && blocks_[i].count == 0;
  };
  const auto free_patch = [&](std::uint32_t i) {
    return i < patches_.size() && patches_[i].blocks == 0;
  };
  // As many in the tables as there are: no key occurs twice.
  return table_.size() == used && patch_table_.size() == used_patches &&
         std::all_of(free_.begin(), free_.end(), free_block) &&
         std::all_of(free_patches_.begin(), free_patches_.end(), free_patch);
}

}  // namespace groundloop
