#include "loopclosure/reference_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include <Eigen/SVD>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kSourcePoints = 20000;
constexpr int kIterationsPerRadius = 40;
constexpr std::size_t kLeastCorrespondences = 100;

// x, y, z in cells, 21 bits each; x varies fastest, so that neighbours along x have keys in a row.
std::uint64_t cell_key(int x, int y, int z) {
  constexpr int kOffset = 1 << 20;
  const auto bits = [](int c) { return static_cast<std::uint64_t>(c + kOffset); };
  return (bits(z) << 42) | (bits(y) << 21) | bits(x);
}

int cell_of(double v, double size) {
  constexpr double kFar = 1e6;
  return static_cast<int>(std::floor(std::clamp(v / size, -kFar, kFar)));
}

struct Pairing {
  Eigen::Vector3d sum_p = Eigen::Vector3d::Zero(), sum_q = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_pq = Eigen::Matrix3d::Zero();
  double squares = 0.0;
  std::size_t count = 0;
  Pairing& operator+=(const Pairing& other) {
    sum_p += other.sum_p;
    sum_q += other.sum_q;
    sum_pq += other.sum_pq;
    squares += other.squares;
    count += other.count;
    return *this;
  }
};

// The motion that brings the paired points p onto q (Kabsch).
Pose motion(const Pairing& sums) {
  const double n = static_cast<double>(sums.count);
  const Eigen::Vector3d p = sums.sum_p / n, q = sums.sum_q / n;
  const Eigen::Matrix3d covariance = sums.sum_pq / n - p * q.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, 1);
  if ((svd.matrixV() * svd.matrixU().transpose()).determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d R = svd.matrixV() * signs.asDiagonal() * svd.matrixU().transpose();
  return Pose(R, q - R * p);
}

}  // namespace

std::vector<std::uint64_t> occupied_voxels(const Points& points, const Pose& T, double size) {
  std::vector<std::uint64_t> keys;
  keys.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3d p = T * point.cast<double>().eval();
    const std::uint64_t key =
        cell_key(cell_of(p.x(), size), cell_of(p.y(), size), cell_of(p.z(), size));
    if (keys.empty() || keys.back() != key) keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

double shared_fraction(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  const std::size_t smaller = std::min(a.size(), b.size());
  if (smaller == 0) return 0.0;
  std::size_t shared = 0, i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (a[i] == b[j]) {
      ++shared, ++i, ++j;
    } else if (a[i] < b[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  return static_cast<double>(shared) / static_cast<double>(smaller);
}

double reference_overlap(const Points& reference, const Points& query,
                         const Pose& T_query_reference, double voxel_size) {
  return shared_fraction(occupied_voxels(reference, T_query_reference, voxel_size),
                         occupied_voxels(query, Pose(), voxel_size));
}

ReferenceTarget::ReferenceTarget(const Points& points) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  order.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    if (!p.allFinite()) continue;
    order.emplace_back(
        cell_key(cell_of(p.x(), kCell), cell_of(p.y(), kCell), cell_of(p.z(), kCell)), i);
  }
  std::sort(order.begin(), order.end());
  points_.reserve(order.size());
  for (const auto& [key, index] : order) {
    if (cells_.empty() || cells_.back() != key) {
      cells_.push_back(key);
      cell_begins_.push_back(static_cast<std::uint32_t>(points_.size()));
    }
    points_.push_back(points[index]);
  }
  cell_begins_.push_back(static_cast<std::uint32_t>(points_.size()));
}

const Eigen::Vector3f* ReferenceTarget::nearest(const Eigen::Vector3f& p, float radius) const {
  const Eigen::Vector3f* best = nullptr;
  float best_squared = radius * radius;
  const auto cell = [&](float v) { return cell_of(static_cast<double>(v), kCell); };
  for (int z = cell(p.z() - radius); z <= cell(p.z() + radius); ++z) {
    for (int y = cell(p.y() - radius); y <= cell(p.y() + radius); ++y) {
      // All cells of the row at once: their keys are consecutive.
      const auto from =
          std::lower_bound(cells_.begin(), cells_.end(), cell_key(cell(p.x() - radius), y, z));
      const auto to = std::upper_bound(from, cells_.end(), cell_key(cell(p.x() + radius), y, z));
      const std::uint32_t begin = cell_begins_[static_cast<std::size_t>(from - cells_.begin())];
      const std::uint32_t end = cell_begins_[static_cast<std::size_t>(to - cells_.begin())];
      for (std::uint32_t i = begin; i < end; ++i) {
        const float squared = (points_[i] - p).squaredNorm();
        if (squared < best_squared) best_squared = squared, best = &points_[i];
      }
    }
  }
  return best;
}

ReferenceAlignment reference_alignment(const ReferenceTarget& query, const Points& reference,
                                       const Pose& T_query_reference_initial) {
  ReferenceAlignment result;
  result.T_query_reference = T_query_reference_initial;
  const std::size_t stride = std::max<std::size_t>(1, reference.size() / kSourcePoints);
  const std::size_t count = (reference.size() + stride - 1) / stride;
  Pose T = T_query_reference_initial;
  for (const float radius : std::array<float, 3>{2.0F, 1.0F, 0.5F}) {
    bool still = false;
    for (int iteration = 0; iteration < kIterationsPerRadius && !still; ++iteration) {
      const PoseF transform(T);
      const Pairing sums =
          ordered_sum(count, 512, Pairing{}, [&](std::size_t begin, std::size_t end) {
            Pairing block;
            for (std::size_t i = begin; i < end; ++i) {
              const Eigen::Vector3f moved = transform * reference[i * stride];
              const Eigen::Vector3f* near =
                  moved.allFinite() ? query.nearest(moved, radius) : nullptr;
              if (near == nullptr) continue;
              const Eigen::Vector3d p = moved.cast<double>(), q = near->cast<double>();
              block.sum_p += p;
              block.sum_q += q;
              block.sum_pq += p * q.transpose();
              block.squares += (p - q).squaredNorm();
              ++block.count;
            }
            return block;
          });
      if (sums.count < kLeastCorrespondences) return result;
      result.correspondences = sums.count;
      result.rmse = std::sqrt(sums.squares / static_cast<double>(sums.count));
      const Pose step = motion(sums);
      T = step * T;
      still = log_se3(step).norm() < 1e-3;
    }
    result.converged = still;
  }
  result.T_query_reference = T;
  return result;
}

}  // namespace groundloop
