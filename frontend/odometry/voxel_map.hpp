// The map odometry registers against: a hash of voxels, each a small block of points kept at a
// distance from each other (KISS-ICP, Vizzo et al., RA-L 2023, Sec. III-C), and the planes they lie
// on: of a voxel where its points span one, else of a patch of three voxels' edge. The patch is
// what makes sparse sensors work: the scan lines of 16 beams cross a voxel once, and lines
// registered to lines drag the pose along and tilt it.
//
// Points are kept relative to the corner of their voxel, and handed out relative to an anchor, a
// corner near the sensor: single precision is then as exact a thousand kilometres from the start as
// at it, and so is what follows from it. Blocks live in one array and are reused; nothing is
// allocated per voxel.
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/voxel_table.hpp"
#include "frontend/odometry/plane_fit.hpp"

namespace groundloop {

/// A frame with the world's axes whose origin is the lower corner of a voxel.
struct MapAnchor {
  Eigen::Vector3i voxel = Eigen::Vector3i::Zero();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of that corner in the world, m

  /// A pose of the world, in this frame.
  [[nodiscard]] Pose inside(const Pose& T_world_x) const {
    Pose T = T_world_x;
    T.translation -= position;
    return T;
  }
  [[nodiscard]] Pose outside(const Pose& T_anchor_x) const {
    Pose T = T_anchor_x;
    T.translation += position;
    return T;
  }
};

class VoxelMap {
 public:
  static constexpr std::size_t kMaxPointsPerVoxel = 20;

  /// voxel_size in metres.
  explicit VoxelMap(float voxel_size);

  [[nodiscard]] float voxel_size() const { return voxel_size_; }
  /// The anchor nearest to a place of the world, m.
  [[nodiscard]] MapAnchor anchor_at(const Eigen::Vector3d& place) const;

  /// In the anchor's frame.
  struct Neighbor {
    Eigen::Vector3f point;
    float squared_distance;  ///< m^2; above the bound asked for where there is no neighbour
    Plane plane;             ///< that the neighbour lies on, if any
    float reach;             ///< how far the query can move, m, with this still its neighbour
  };

  /// The nearest point within `max_distance` of p (in the anchor's frame, m) among the voxel of p
  /// and its 26 neighbours. Exact: a voxel is passed over only where it is farther than the best
  /// point so far. Safe to call from many threads.
  [[nodiscard]] Neighbor nearest(const MapAnchor& anchor, const Eigen::Vector3f& p,
                                 float max_distance) const;

  /// Adds points (scan frame, m). A point nearer than voxel_size / sqrt(20) to another of its voxel
  /// is left out, but counts for the plane of its patch.
  void insert(const Points& points, const Pose& T_world_scan);

  /// Drops voxels whose corner is farther than `distance` from `center`, m.
  void remove_beyond(const Eigen::Vector3d& center, float distance);
  void clear();

  [[nodiscard]] bool empty() const { return table_.size() == 0; }
  [[nodiscard]] std::size_t voxels() const { return table_.size(); }

  /// Exact state for a resumable session. What load() reads may come from anybody: where it is no
  /// map, `in` is left failed.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  // Coordinates apart, so that the distances to all points of a block are computed in vector
  // registers. All relative to the voxel's lower corner.
  struct Block {
    alignas(16) std::array<float, kMaxPointsPerVoxel> x, y, z;
    Plane plane;
    VoxelKey key;
    std::uint32_t count;
    std::uint32_t count_of_plane;  // points that the plane was fitted to
    std::uint32_t patch;
    std::uint32_t padding;  // named, so that every byte of a saved state is defined
  };
  // Relative to the patch's centre.
  struct Patch {
    VoxelKey key;
    PlaneMoments moments;
    Plane plane;
    std::uint32_t blocks;   // that lie in it
    std::uint32_t touched;  // listed in touched_patches_
  };

  // Indices and counts that fit each other, as in every map that insert() made.
  [[nodiscard]] bool consistent() const;
  std::uint32_t block_at(const Eigen::Vector3i& voxel);
  std::uint32_t patch_at(const Eigen::Vector3i& voxel);
  // From the corner of a voxel to the centre of its patch, m.
  [[nodiscard]] Eigen::Vector3f patch_center(const Eigen::Vector3i& voxel) const;
  [[nodiscard]] bool add_to_block(Block& block, const Eigen::Vector3f& p) const;
  void update_plane(Block& block) const;
  void update_plane(Patch& patch) const;
  // Of a point of a block, both relative to the corner of the block's voxel.
  [[nodiscard]] Plane plane_of(const Block& block, const Eigen::Vector3i& voxel,
                               const Eigen::Vector3f& point) const;

  float voxel_size_;
  float inverse_size_;
  float min_spacing_squared_;
  VoxelTable table_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> free_;
  VoxelTable patch_table_;
  std::vector<Patch> patches_;
  std::vector<std::uint32_t> free_patches_;
  // Blocks and patches that gained points in this insert().
  std::vector<std::uint32_t> touched_, touched_patches_;
};

}  // namespace groundloop
