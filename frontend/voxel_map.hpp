// The map odometry registers against: a hash of voxels, each a small block of points kept at a
// distance from each other (KISS-ICP, Vizzo et al., RA-L 2023, Sec. III-C), with the plane they lie
// on where there is one. Blocks live in one array and are reused; nothing is allocated per voxel.
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {

class VoxelMap {
 public:
  static constexpr std::size_t kMaxPointsPerVoxel = 20;

  /// voxel_size in metres.
  explicit VoxelMap(float voxel_size);

  struct Neighbor {
    Eigen::Vector3f point;
    float squared_distance;  ///< metres squared; above the bound asked for where there is no
                             ///< neighbour
    Eigen::Vector3f
        normal;  ///< of the plane that the points of its voxel lie on; zero where they do not
  };

  /// The nearest point within `max_distance` among the voxel of p and its 26 neighbours. Exact: a
  /// voxel is passed over only where it is farther than the best point so far. Safe to call from
  /// many threads.
  [[nodiscard]] Neighbor nearest(const Eigen::Vector3f& p, float max_distance) const;

  /// Adds points (world frame). A point nearer than voxel_size / sqrt(20) to another of its voxel
  /// is left out.
  void insert(const Points& points, const Pose& T_world_scan);

  /// Drops voxels whose first point is farther than `distance` from `center`.
  void remove_beyond(const Eigen::Vector3f& center, float distance);

  [[nodiscard]] bool empty() const { return table_.size() == 0; }
  [[nodiscard]] std::size_t voxels() const { return table_.size(); }

  /// Exact state for a resumable session.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  // Coordinates apart, so that the distances to all points of a block are computed in vector
  // registers.
  struct Block {
    alignas(16) std::array<float, kMaxPointsPerVoxel> x, y, z;
    std::array<float, 3> normal;
    VoxelKey key;
    std::uint32_t count;
    std::uint32_t count_of_normal;  // points that the normal was computed from
  };

  void add_to_block(Block& block, const Eigen::Vector3f& p) const;
  void update_normal(Block& block) const;

  float voxel_size_;
  float inverse_size_;
  float min_spacing_squared_;
  VoxelTable table_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> touched_;  // blocks that gained points in this insert()
};

}  // namespace groundloop
