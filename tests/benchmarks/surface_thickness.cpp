#include "tests/benchmarks/surface_thickness.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "frontend/core/voxel_table.hpp"

namespace groundloop {
namespace {

constexpr float kCell = 1.0F;
constexpr int kMinPoints = 30, kMinScans = 3;

struct Cell {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  int points = 0, scans = 0;
  std::size_t last_scan = static_cast<std::size_t>(-1);
};

}  // namespace

void SurfaceThickness::add(const Points& points, const Pose& T_world_scan) {
  scans_.emplace_back(points, T_world_scan);
  if (scans_.size() == window_) measure();
}

void SurfaceThickness::measure() {
  VoxelTable table(1 << 14);
  std::vector<Cell> cells;
  // About the first scan of the window, so that floats suffice.
  const Pose origin = scans_.front().second.inverse();
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    const Pose T = origin * scans_[k].second;
    for (const Eigen::Vector3f& point : scans_[k].first) {
      const Eigen::Vector3d p = T * Eigen::Vector3d(point.cast<double>());
      const auto fresh = static_cast<std::uint32_t>(cells.size());
      const std::uint32_t i =
          table.find_or_insert(voxel_key(voxel_of(p.cast<float>(), 1.0F / kCell)), fresh);
      if (i == fresh) cells.emplace_back();
      Cell& cell = cells[i];
      cell.sum += p;
      cell.squares += p * p.transpose();
      ++cell.points;
      if (cell.last_scan != k) ++cell.scans;
      cell.last_scan = k;
    }
  }
  for (const Cell& cell : cells) {
    if (cell.points < kMinPoints || cell.scans < kMinScans) continue;
    const Eigen::Vector3d mean = cell.sum / cell.points;
    const Eigen::Matrix3d covariance = cell.squares / cell.points - mean * mean.transpose();
    const Eigen::Vector3d deviation = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance)
                                          .eigenvalues()
                                          .cwiseMax(0.0)
                                          .cwiseSqrt();
    if (deviation(1) > 2.0 * deviation(0) && deviation(1) > 0.15)
      thicknesses_.push_back(deviation(0));
  }
  scans_.clear();
}

double SurfaceThickness::median() {
  if (scans_.size() > window_ / 2 || thicknesses_.empty()) {
    if (!scans_.empty()) measure();
  }
  if (thicknesses_.empty()) return 0.0;
  const auto middle = thicknesses_.begin() + static_cast<std::ptrdiff_t>(thicknesses_.size() / 2);
  std::nth_element(thicknesses_.begin(), middle, thicknesses_.end());
  return *middle;
}

}  // namespace groundloop
