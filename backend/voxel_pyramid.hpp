// A point cloud as cells of 0.5, 1, 2, 4 ... m with their means and, where wanted, their planes:
// what closures are refined on. Cells keep the order in which their first points come, so that
// everything summed over them is the same from run to run.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/scan.hpp"

namespace groundloop {

/// Three cell numbers in one key. Cell numbers beyond +-2^20 have no key: 524 km at 0.5 m.
using VoxelKey = std::uint64_t;
constexpr VoxelKey kNoVoxel = ~VoxelKey{0};

[[nodiscard]] inline VoxelKey voxel_key(const Eigen::Vector3i& cell) {
  constexpr int kHalf = 1 << 20;
  VoxelKey key = 0;
  for (int k = 0; k < 3; ++k) {
    if (cell[k] < -kHalf || cell[k] >= kHalf) return kNoVoxel;
    key = (key << 21) | static_cast<VoxelKey>(cell[k] + kHalf);
  }
  return key;
}

/// The cell of a point; cells beyond the keys' range for points that are no finite number.
[[nodiscard]] inline Eigen::Vector3i voxel_cell(const Eigen::Vector3f& point, float inverse_size) {
  Eigen::Vector3i cell;
  for (int k = 0; k < 3; ++k) {
    const float scaled = std::floor(point[k] * inverse_size);
    cell[k] = std::abs(scaled) < 1.5e9F ? static_cast<int>(scaled) : 1 << 30;
  }
  return cell;
}

/// Numbers the keys in the order of their first insertion: open addressing in one flat table.
class VoxelIndex {
 public:
  explicit VoxelIndex(std::size_t expected = 0);
  /// The number of `key`, a new one where it was not there. `key` must not be kNoVoxel.
  int insert(VoxelKey key);
  /// -1 where it is not there.
  [[nodiscard]] int find(VoxelKey key) const {
    for (std::size_t slot = slot_of(key);; slot = (slot + 1) & mask_) {
      if (slots_[slot].key == key) return slots_[slot].number;
      if (slots_[slot].key == kNoVoxel) return -1;
    }
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  struct Slot {
    VoxelKey key = kNoVoxel;
    int number = -1;
  };
  [[nodiscard]] std::size_t slot_of(VoxelKey key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> shift_);
  }
  void grow();

  std::vector<Slot> slots_;
  std::size_t mask_ = 0;
  std::size_t size_ = 0;
  int shift_ = 0;
};

struct VoxelLevel {
  float voxel_size = 0.0F;
  VoxelIndex index;
  std::vector<Eigen::Vector3f> means;  ///< of the points of a cell
  /// Unit normals of the cells' surfaces; zero where the points form none. Empty without planes.
  std::vector<Eigen::Vector3f> normals;
  /// Variance of the points across the surface, m^2.
  std::vector<float> variances;
};

class VoxelPyramid {
 public:
  /// Cells of `voxel_size`, then twice that, `levels` times; `planes` adds normals. Points that are
  /// not finite are left out.
  VoxelPyramid(const Points& points, double voxel_size, int levels, bool planes);

  /// Finest first.
  [[nodiscard]] const std::vector<VoxelLevel>& levels() const { return levels_; }
  [[nodiscard]] const VoxelLevel& finest() const { return levels_.front(); }

 private:
  std::vector<VoxelLevel> levels_;
};

}  // namespace groundloop
