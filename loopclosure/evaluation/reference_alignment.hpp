// Overlap and point-to-point ICP of the evaluation (Sec. 4.3 and 5.5 of the paper). Written apart
// from the verification in backend, which it judges, and sharing no code with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

/// Voxels of edge `size` (m) that hold points of a map, moved by T first.
class OccupiedVoxels {
 public:
  OccupiedVoxels(const Points& points, const Pose& T, double size);

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Voxels shared with another map, moved by T first, over those of the map with fewer; 0 where
  /// one has none, or where none of every 32nd of at least 3200 points of the other lies in one of
  /// these voxels.
  [[nodiscard]] double overlap(const Points& other, const Pose& T) const;

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  static std::uint64_t key_of(const Eigen::Vector3f& point, const Pose& T, double size);
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const;

  double size_;
  std::size_t count_ = 0;
  std::vector<std::uint64_t> keys_;  // open addressing
};

/// Overlap of two maps in the query's frame.
[[nodiscard]] double reference_overlap(const Points& reference, const Points& query,
                                       const Pose& T_query_reference, double voxel_size = 0.5);

/// A map prepared as target of reference_alignment: a k-d tree.
class ReferenceTarget {
 public:
  explicit ReferenceTarget(const Points& points);

  /// The finite points, in an order of its own.
  [[nodiscard]] const Points& points() const { return points_; }
  /// Index of the point nearest to p that is nearer than `radius`, if there is one. `guess`, the
  /// index of some point, only speeds up the search where it is near.
  [[nodiscard]] std::optional<std::size_t> nearest(
      const Eigen::Vector3f& p, float radius,
      std::optional<std::size_t> guess = std::nullopt) const;

 private:
  static constexpr std::size_t kLeaf = 12;
  struct Nearest {
    std::size_t index;
    float squared;
  };
  void split(std::size_t begin, std::size_t end);
  void search(const Eigen::Vector3f& p, std::size_t begin, std::size_t end, Nearest& best) const;

  Points points_;
  std::vector<std::uint8_t> axes_;
};

struct ReferenceAlignment {
  Pose T_query_reference;
  double rmse = 0.0;  ///< m, of the correspondences of the last iteration
  std::size_t correspondences = 0;
  bool converged = false;
};

/// Point-to-point ICP of reference points onto the query map from `initial`: correspondences within
/// 2 m, later within 1 m and 0.5 m. Not converged where fewer than 100 correspondences are left;
/// the pose is then the initial one.
[[nodiscard]] ReferenceAlignment reference_alignment(const ReferenceTarget& query,
                                                     const Points& reference,
                                                     const Pose& T_query_reference_initial);

}  // namespace groundloop
