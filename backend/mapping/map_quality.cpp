#include "backend/mapping/map_quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/LU>

#include "backend/registration/cell_moments.hpp"

namespace groundloop {
namespace {

constexpr float kMissing = 0.5F;

struct Mean {
  double sum = 0.0;
  std::size_t count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  [[nodiscard]] double value() const { return count > 0 ? sum / static_cast<double>(count) : 0.0; }
};

// The smallest distance to the surfaces of the cells around, kMissing at most.
float distance_to_surface(const VoxelLevel& level, const Eigen::Vector3f& point) {
  const Eigen::Vector3i centre = voxel_of(point, 1.0F / level.voxel_size);
  float best = kMissing;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3i cell = centre + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    const std::uint32_t number = level.index.find(voxel_key(cell));
    if (number == VoxelTable::kNone || level.normals[number].isZero(0.0F)) continue;
    const Eigen::Vector3f between = point - level.means[number];
    if (between.squaredNorm() > level.voxel_size * level.voxel_size) continue;
    best = std::min(best, std::abs(level.normals[number].dot(between)));
  }
  return best;
}

Mean thickness(const VoxelPyramid& query, const Points& reference, const Pose& T_query_reference) {
  const std::size_t coarse_at = std::min<std::size_t>(3, query.levels().size() - 1);
  const VoxelLevel& coarse = query.levels()[coarse_at];
  const VoxelPyramid cells(reference, query.finest().voxel_size, 1, false);
  const PoseF T(T_query_reference);
  Mean mean;
  for (const Eigen::Vector3f& point : cells.finest().means) {
    const Eigen::Vector3f moved = T * point;
    if (!has_voxel(moved)) continue;
    const VoxelKey key = voxel_key(voxel_of(moved, 1.0F / coarse.voxel_size));
    if (coarse.index.find(key) == VoxelTable::kNone) continue;
    mean.add(distance_to_surface(query.finest(), moved));
  }
  return mean;
}

struct SharedCell {
  CellMoments both;
  std::array<int, 2> points{};
};

Mean entropy(const Points& query, const Points& reference, const Pose& T_query_reference) {
  constexpr int kMinPoints = 5;
  constexpr double kCell = 1.0;
  // Returns of one beam lie in a line or plane exactly; a centimetre of noise keeps the logarithm.
  constexpr double kNoise = 1e-4;
  VoxelTable index(query.size() / 8);
  std::vector<SharedCell> cells;
  const auto add = [&](const Points& points, const Pose& pose, std::size_t map) {
    const PoseF T(pose);
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3f moved = T * point;
      if (!has_voxel(moved)) continue;
      const auto next = static_cast<std::uint32_t>(cells.size());
      const VoxelKey key = voxel_key(voxel_of(moved, static_cast<float>(1.0 / kCell)));
      const std::uint32_t number = index.find_or_insert(key, next);
      if (number == next) cells.emplace_back();
      cells[number].both.add(moved);
      ++cells[number].points[map];
    }
  };
  add(query, Pose(), 0);
  add(reference, T_query_reference, 1);
  Mean mean;
  for (const SharedCell& cell : cells) {
    if (std::min(cell.points[0], cell.points[1]) < kMinPoints) continue;
    const Eigen::Matrix3d covariance =
        cell.both.covariance() + kNoise * Eigen::Matrix3d::Identity();
    mean.add(0.5 * (3.0 * std::log(2.0 * std::numbers::pi * std::numbers::e) +
                    std::log(covariance.determinant())));
  }
  return mean;
}

double weighted(double a, std::size_t n, double b, std::size_t m) {
  if (n + m == 0) return 0.0;
  return (a * static_cast<double>(n) + b * static_cast<double>(m)) / static_cast<double>(n + m);
}

}  // namespace

RevisitQuality revisit_quality(const RegistrationTarget& query_target, const Points& query,
                               const Points& reference, const Pose& T_query_reference) {
  const Mean planes = thickness(query_target.pyramid(), reference, T_query_reference);
  const Mean blur = entropy(query, reference, T_query_reference);
  return {planes.value(), blur.value(), planes.count, blur.count};
}

RevisitQuality combine(const RevisitQuality& a, const RevisitQuality& b) {
  return {weighted(a.plane_thickness, a.cells, b.plane_thickness, b.cells),
          weighted(a.entropy, a.entropy_cells, b.entropy, b.entropy_cells), a.cells + b.cells,
          a.entropy_cells + b.entropy_cells};
}

}  // namespace groundloop
