#include "loopclosure/voxel_normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "frontend/core/voxel_table.hpp"

namespace groundloop {
namespace {

constexpr float kMaxCoordinate = 1e4F;
constexpr std::size_t kBlock = 64;
constexpr float kMinPoints = 5;
// A plane: its thickness is less than this part of its smaller extent (standard deviations).
constexpr float kMaxFlatness = 0.3F;

bool usable(const Eigen::Vector3f& p) {
  // Comparisons with NaN are false.
  return std::abs(p.x()) < kMaxCoordinate && std::abs(p.y()) < kMaxCoordinate &&
         std::abs(p.z()) < kMaxCoordinate;
}

// Which of a group of `size` points to take: evenly spread over the groups (the golden ratio), as a
// fixed place would follow the pattern in which a sensor or a grid lays out its points.
std::size_t pick(std::uint32_t group, std::size_t size) {
  return (std::uint64_t{group * 0x9e3779b9U} * size) >> 32;
}

}  // namespace

VoxelNormals::VoxelNormals(const Points& points, double size, std::size_t max_points) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / max_points);
  const auto inverse = static_cast<float>(1.0 / size);
  const auto edge = static_cast<float>(size);
  const std::size_t expected = points.size() / stride / 8;
  VoxelTable table(expected);
  moments_.reserve(expected);
  std::vector<Eigen::Vector3f> corners;
  corners.reserve(moments_.capacity());
  // Neither the table nor the moments fit in the nearest cache, and points of one voxel lie far
  // apart: a block of points asks for its slots, then for its moments, before it waits for either.
  struct Sample {
    Moments moments;
    Eigen::Vector3f corner;
    std::uint32_t index;
    VoxelKey key;
  };
  std::array<Sample, kBlock> block;
  std::uint32_t group = 0;
  for (std::size_t n = 0; n < points.size();) {
    std::size_t count = 0;
    for (; n < points.size() && count < kBlock; n += stride, ++group) {
      const Eigen::Vector3f& p = points[n + pick(group, std::min(stride, points.size() - n))];
      __builtin_prefetch(&points[std::min(n + kBlock * stride, points.size() - 1)]);
      if (!usable(p)) continue;
      const Eigen::Vector3i voxel = voxel_of(p, inverse);
      Sample& sample = block[count++];
      sample.corner = voxel.cast<float>() * edge;
      sample.key = voxel_key(voxel);
      table.prefetch(sample.key);
      const Eigen::Vector3f d = p - sample.corner;
      sample.moments.first << d.x(), d.y(), d.z(), 1.0F;
      sample.moments.square << d.x() * d.x(), d.y() * d.y(), d.z() * d.z(), 0.0F;
      sample.moments.mixed << d.x() * d.y(), d.x() * d.z(), d.y() * d.z(), 0.0F;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto fresh = static_cast<std::uint32_t>(moments_.size());
      block[i].index = table.find_or_insert(block[i].key, fresh);
      if (block[i].index == fresh) {
        moments_.emplace_back();
        corners.push_back(block[i].corner);
      } else {
        __builtin_prefetch(&moments_[block[i].index], 1);
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      Moments& m = moments_[block[i].index];
      m.first += block[i].moments.first;
      m.square += block[i].moments.square;
      m.mixed += block[i].moments.mixed;
    }
  }
  means_.resize(moments_.size());
  for (std::size_t v = 0; v < moments_.size(); ++v) {
    const Moments& m = moments_[v];
    means_[v] = corners[v] + m.first.head<3>().matrix() / m.first.w();
  }
  normals_.assign(moments_.size(), Eigen::Vector3f::Zero());
  known_.assign(moments_.size(), 0);
}

const Eigen::Vector3f& VoxelNormals::normal(std::size_t i) const {
  if (known_[i] != 0) return normals_[i];
  known_[i] = 1;
  const Moments& m = moments_[i];
  const float n_points = m.first.w();
  if (n_points < kMinPoints) return normals_[i];
  const Eigen::Array3f mean = m.first.head<3>() / n_points;
  const Eigen::Array3f variance = m.square.head<3>() / n_points - mean.square();
  const float xy = m.mixed.x() / n_points - mean.x() * mean.y();
  const float xz = m.mixed.y() / n_points - mean.x() * mean.z();
  const float yz = m.mixed.z() / n_points - mean.y() * mean.z();
  Eigen::Matrix3f covariance;
  covariance << variance.x(), xy, xz, xy, variance.y(), yz, xz, yz, variance.z();
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
