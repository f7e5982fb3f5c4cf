#include "frontend/voxel_map.hpp"

#include <algorithm>
#include <istream>
#include <ostream>

#include <Eigen/Eigenvalues>

#include "frontend/core/binary_io.hpp"

namespace groundloop {

VoxelMap::VoxelMap(float voxel_size)
    : voxel_size_(voxel_size),
      inverse_size_(1.0F / voxel_size),
      min_spacing_squared_(voxel_size * voxel_size / static_cast<float>(kMaxPointsPerVoxel)),
      table_(1 << 15) {}

VoxelMap::Neighbor VoxelMap::nearest(const Eigen::Vector3f& p, float max_distance) const {
  const Eigen::Vector3i center = voxel_of(p, inverse_size_);
  const float unreachable = std::nextafter(max_distance * max_distance, INFINITY);
  Neighbor best{Eigen::Vector3f::Zero(), unreachable, Eigen::Vector3f::Zero()};
  const Block* best_block = nullptr;

  const auto search_block = [&](VoxelKey key) {
    const std::uint32_t index = table_.find(key);
    if (index == VoxelTable::kNone) return;
    const Block& block = blocks_[index];
    std::array<float, kMaxPointsPerVoxel> d{};
    for (std::size_t i = 0; i < kMaxPointsPerVoxel; ++i) {
      const float dx = block.x[i] - p.x(), dy = block.y[i] - p.y(), dz = block.z[i] - p.z();
      d[i] = dx * dx + dy * dy + dz * dz;
    }
    for (std::size_t i = 0; i < block.count; ++i) {
      if (d[i] < best.squared_distance) {
        best.squared_distance = d[i];
        best.point = {block.x[i], block.y[i], block.z[i]};
        best_block = &block;
      }
    }
  };

  search_block(voxel_key(center));
  // Squared distance from p to the slab of the neighbours at -1, 0 and +1 along each axis.
  std::array<std::array<float, 3>, 3> gap{};
  for (int axis = 0; axis < 3; ++axis) {
    const float inside = p(axis) - static_cast<float>(center(axis)) * voxel_size_;
    const float below = std::max(0.0F, inside);
    const float above = std::max(0.0F, voxel_size_ - inside);
    gap[static_cast<std::size_t>(axis)] = {below * below, 0.0F, above * above};
  }
  for (int dx = 0; dx < 3; ++dx) {
    if (gap[0][dx] >= best.squared_distance) continue;
    for (int dy = 0; dy < 3; ++dy) {
      const float gap_xy = gap[0][dx] + gap[1][dy];
      if (gap_xy >= best.squared_distance) continue;
      for (int dz = 0; dz < 3; ++dz) {
        if (gap_xy + gap[2][dz] >= best.squared_distance || (dx == 1 && dy == 1 && dz == 1))
          continue;
        search_block(voxel_key(center + Eigen::Vector3i(dx - 1, dy - 1, dz - 1)));
      }
    }
  }
  if (best_block != nullptr) best.normal = Eigen::Vector3f(best_block->normal.data());
  return best;
}

void VoxelMap::update_normal(Block& block) const {
  constexpr std::uint32_t kMinPoints = 6;
  // A voxel is planar where its points are within a tenth of its edge of a plane that they span in
  // both directions.
  constexpr float kThickness = 0.1F, kSpread = 0.15F;
  block.count_of_normal = block.count;
  block.normal.fill(0.0F);
  if (block.count < kMinPoints) return;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (std::uint32_t i = 0; i < block.count; ++i)
    mean += Eigen::Vector3f(block.x[i], block.y[i], block.z[i]);
  mean /= static_cast<float>(block.count);
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const Eigen::Vector3f d = Eigen::Vector3f(block.x[i], block.y[i], block.z[i]) - mean;
    covariance += d * d.transpose();
  }
  covariance /= static_cast<float>(block.count);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f variance = solver.eigenvalues();
  const auto square = [](float v) { return v * v; };
  if (variance(0) > square(kThickness * voxel_size_) || variance(1) < square(kSpread * voxel_size_))
    return;
  const Eigen::Vector3f normal = solver.eigenvectors().col(0);
  block.normal = {normal.x(), normal.y(), normal.z()};
}

void VoxelMap::add_to_block(Block& block, const Eigen::Vector3f& p) const {
  if (block.count == kMaxPointsPerVoxel) return;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const float dx = block.x[i] - p.x(), dy = block.y[i] - p.y(), dz = block.z[i] - p.z();
    if (dx * dx + dy * dy + dz * dz < min_spacing_squared_) return;
  }
  block.x[block.count] = p.x();
  block.y[block.count] = p.y();
  block.z[block.count] = p.z();
  ++block.count;
}

void VoxelMap::insert(const Points& points, const Pose& T_world_scan) {
  const PoseF T(T_world_scan);
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = T * point;
    const VoxelKey key = voxel_key(voxel_of(p, inverse_size_));
    const auto fresh = free_.empty() ? static_cast<std::uint32_t>(blocks_.size()) : free_.back();
    const std::uint32_t index = table_.find_or_insert(key, fresh);
    if (index == fresh) {
      if (free_.empty()) {
        blocks_.emplace_back();
      } else {
        free_.pop_back();
      }
      Block& block = blocks_[index];
      block.x.fill(0.0F);
      block.y.fill(0.0F);
      block.z.fill(0.0F);
      block.normal.fill(0.0F);
      block.key = key;
      block.count = 0;
      block.count_of_normal = 0;
    }
    Block& block = blocks_[index];
    const std::uint32_t before = block.count;
    add_to_block(block, p);
    // The first point it gains in this call lists the block.
    if (block.count != before && before == block.count_of_normal) touched_.push_back(index);
  }
  for (const std::uint32_t index : touched_) update_normal(blocks_[index]);
  touched_.clear();
}

void VoxelMap::remove_beyond(const Eigen::Vector3f& center, float distance) {
  const float limit = distance * distance;
  for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
    Block& block = blocks_[i];
    if (block.count == 0) continue;
    if ((Eigen::Vector3f(block.x[0], block.y[0], block.z[0]) - center).squaredNorm() <= limit)
      continue;
    table_.erase(block.key);
    block.count = 0;
    free_.push_back(i);
  }
}

void VoxelMap::save(std::ostream& out) const {
  put_all(out, blocks_);
  put_all(out, free_);
}

void VoxelMap::load(std::istream& in) {
  get_all(in, blocks_);
  get_all(in, free_);
  table_.clear();
  for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].count > 0) table_.find_or_insert(blocks_[i].key, i);
  }
}

}  // namespace groundloop
