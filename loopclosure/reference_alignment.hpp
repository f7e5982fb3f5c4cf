// Overlap and point-to-point ICP of the evaluation (Sec. 4.3 and 5.5 of the paper). Written apart
// from the verification in backend, which it judges, and sharing no code with it.
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

/// Voxels of edge `size` (m) that hold points of a map, moved by T first; sorted, each once.
[[nodiscard]] std::vector<std::uint64_t> occupied_voxels(const Points& points, const Pose& T,
                                                         double size);

/// Shared voxels over those of the smaller set; 0 where one is empty. Both sorted.
[[nodiscard]] double shared_fraction(const std::vector<std::uint64_t>& a,
                                     const std::vector<std::uint64_t>& b);

/// Overlap of two maps in the query's frame.
[[nodiscard]] double reference_overlap(const Points& reference, const Points& query,
                                       const Pose& T_query_reference, double voxel_size = 0.5);

/// A map prepared as target of reference_alignment.
class ReferenceTarget {
 public:
  explicit ReferenceTarget(const Points& points);

  /// The point nearest to p within `radius` <= 2 m, or null.
  [[nodiscard]] const Eigen::Vector3f* nearest(const Eigen::Vector3f& p, float radius) const;

 private:
  static constexpr float kCell = 1.0F;
  std::vector<Eigen::Vector3f> points_;     // cell by cell
  std::vector<std::uint64_t> cells_;        // sorted keys
  std::vector<std::uint32_t> cell_begins_;  // one more than cells
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
