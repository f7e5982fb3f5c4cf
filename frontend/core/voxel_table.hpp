// An open-addressing hash table from voxels to 32-bit indices: one allocation for all voxels,
// linear probing, removal by backward shift. The voxel maps of odometry and of local maps, and
// downsampling, stand on it.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace groundloop {

using VoxelKey = std::uint64_t;

/// Integer coordinates of the voxel of edge 1 / `inverse_size` that holds p (floor, not
/// truncation).
[[nodiscard]] inline Eigen::Vector3i voxel_of(const Eigen::Vector3f& p, float inverse_size) {
  const auto floor_to_int = [](float v) {
    const int i = static_cast<int>(v);
    return i - static_cast<int>(v < static_cast<float>(i));
  };
  return {floor_to_int(p.x() * inverse_size), floor_to_int(p.y() * inverse_size),
          floor_to_int(p.z() * inverse_size)};
}

/// 21 bits a coordinate: unique within any 2 097 152 voxels along an axis; farther ones share keys.
[[nodiscard]] inline VoxelKey voxel_key(const Eigen::Vector3i& v) {
  constexpr int kOffset = 1 << 20;
  constexpr std::uint64_t kMask = (1ULL << 21) - 1;
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + kOffset) & kMask; };
  return part(v.x()) | (part(v.y()) << 21) | (part(v.z()) << 42);
}

[[nodiscard]] inline Eigen::Vector3i voxel_from_key(VoxelKey key) {
  constexpr int kOffset = 1 << 20;
  constexpr std::uint64_t kMask = (1ULL << 21) - 1;
  const auto part = [&](int shift) { return static_cast<int>((key >> shift) & kMask) - kOffset; };
  return {part(0), part(21), part(42)};
}

/// Steps from voxel b to voxel a, right also where the keys of far voxels have wrapped around.
[[nodiscard]] inline Eigen::Vector3i voxel_step(VoxelKey a, VoxelKey b) {
  constexpr int kOffset = 1 << 20, kMask = (1 << 21) - 1;
  const Eigen::Vector3i d = voxel_from_key(a) - voxel_from_key(b);
  const auto wrap = [](int c) { return ((c + kOffset) & kMask) - kOffset; };
  return {wrap(d.x()), wrap(d.y()), wrap(d.z())};
}

class VoxelTable {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  explicit VoxelTable(std::size_t expected = 1024) { allocate(expected); }

  [[nodiscard]] std::size_t size() const { return size_; }

  /// The index stored for `key`, or kNone.
  [[nodiscard]] std::uint32_t find(VoxelKey key) const {
    for (std::size_t slot = slot_of(key);; slot = (slot + 1) & mask_) {
      if (slots_[slot].index == kNone) return kNone;
      if (slots_[slot].key == key) return slots_[slot].index;
    }
  }

  /// The index stored for `key`; where there is none, stores `index` and returns it.
  std::uint32_t find_or_insert(VoxelKey key, std::uint32_t index) {
    std::size_t slot = slot_of(key);
    for (; slots_[slot].index != kNone; slot = (slot + 1) & mask_) {
      if (slots_[slot].key == key) return slots_[slot].index;
    }
    slots_[slot] = {key, index};
    if (++size_ * 2 > slots_.size()) grow();
    return index;
  }

  void erase(VoxelKey key) {
    std::size_t hole = slot_of(key);
    for (; slots_[hole].key != key || slots_[hole].index == kNone; hole = (hole + 1) & mask_) {
      if (slots_[hole].index == kNone) return;
    }
    for (std::size_t next = (hole + 1) & mask_; slots_[next].index != kNone;
         next = (next + 1) & mask_) {
      // An entry may move into the hole if its home does not lie between the hole and itself.
      const std::size_t home = slot_of(slots_[next].key);
      if (((next - home) & mask_) >= ((next - hole) & mask_)) {
        slots_[hole] = slots_[next];
        hole = next;
      }
    }
    slots_[hole].index = kNone;
    --size_;
  }

  void clear() {
    for (Slot& slot : slots_) slot.index = kNone;
    size_ = 0;
  }

  /// Brings the memory of the slot that `key` starts at nearer, ahead of find().
  void prefetch(VoxelKey key) const { __builtin_prefetch(&slots_[slot_of(key)]); }

 private:
  struct Slot {
    VoxelKey key;
    std::uint32_t index;
  };

  [[nodiscard]] std::size_t slot_of(VoxelKey key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> shift_);
  }

  void allocate(std::size_t expected) {
    int bits = 6;
    while ((std::size_t{1} << bits) < expected * 2) ++bits;
    slots_.assign(std::size_t{1} << bits, Slot{0, kNone});
    mask_ = slots_.size() - 1;
    shift_ = 64 - bits;
    size_ = 0;
  }

  void grow() {
    std::vector<Slot> old;
    old.swap(slots_);
    allocate(old.size());
    for (const Slot& slot : old) {
      if (slot.index != kNone) find_or_insert(slot.key, slot.index);
    }
  }

  std::vector<Slot> slots_;
  std::size_t mask_ = 0;
  std::size_t size_ = 0;
  int shift_ = 0;
};

}  // namespace groundloop
