#include "loopclosure/voxel_normals.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "frontend/core/voxel_table.hpp"

namespace groundloop {
namespace {

constexpr float kMaxCoordinate = 1e4F;
constexpr float kMinPoints = 5;
// A plane: its thickness is less than this part of its smaller extent (standard deviations).
constexpr float kMaxFlatness = 0.3F;

bool usable(const Eigen::Vector3f& p) {
  // Comparisons with NaN are false.
  return std::abs(p.x()) < kMaxCoordinate && std::abs(p.y()) < kMaxCoordinate &&
         std::abs(p.z()) < kMaxCoordinate;
}

}  // namespace

VoxelNormals::VoxelNormals(const Points& points, double size, std::size_t max_points) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / max_points);
  const auto inverse = static_cast<float>(1.0 / size);
  const auto edge = static_cast<float>(size);
  VoxelTable table(points.size() / 8);
  std::vector<Eigen::Vector3f> corners;
  VoxelKey last_key = ~VoxelKey{0};  // no key has its upper bit set
  std::uint32_t index = 0;
  for (std::size_t n = 0; n < points.size(); n += stride) {
    const Eigen::Vector3f& p = points[n];
    if (!usable(p)) continue;
    const Eigen::Vector3i voxel = voxel_of(p, inverse);
    const VoxelKey key = voxel_key(voxel);
    if (key != last_key) {
      const auto fresh = static_cast<std::uint32_t>(moments_.size());
      index = table.find_or_insert(key, fresh);
      if (index == fresh) {
        moments_.emplace_back();
        corners.push_back(voxel.cast<float>() * edge);
      }
      last_key = key;
    }
    const Eigen::Vector3f d = p - corners[index];
    Moments& m = moments_[index];
    m.n += 1;
    m.x += d.x();
    m.y += d.y();
    m.z += d.z();
    m.xx += d.x() * d.x();
    m.xy += d.x() * d.y();
    m.xz += d.x() * d.z();
    m.yy += d.y() * d.y();
    m.yz += d.y() * d.z();
    m.zz += d.z() * d.z();
  }
  means_.resize(moments_.size());
  for (std::size_t v = 0; v < moments_.size(); ++v) {
    const Moments& m = moments_[v];
    means_[v] = corners[v] + Eigen::Vector3f(m.x, m.y, m.z) / m.n;
  }
  normals_.assign(moments_.size(), Eigen::Vector3f::Zero());
  known_.assign(moments_.size(), 0);
}

const Eigen::Vector3f& VoxelNormals::normal(std::size_t i) const {
  if (known_[i] != 0) return normals_[i];
  known_[i] = 1;
  const Moments& m = moments_[i];
  if (m.n < kMinPoints) return normals_[i];
  const float x = m.x / m.n, y = m.y / m.n, z = m.z / m.n;
  Eigen::Matrix3f covariance;
  covariance << m.xx / m.n - x * x, m.xy / m.n - x * y, m.xz / m.n - x * z,  //
      m.xy / m.n - x * y, m.yy / m.n - y * y, m.yz / m.n - y * z,            //
      m.xz / m.n - x * z, m.yz / m.n - y * z, m.zz / m.n - z * z;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f values = solver.eigenvalues();
  if (values.y() > 0 && values.x() < kMaxFlatness * kMaxFlatness * values.y()) {
    const Eigen::Vector3f n = solver.eigenvectors().col(0);
    if (n.allFinite()) normals_[i] = n.normalized();
  }
  return normals_[i];
}

}  // namespace groundloop
