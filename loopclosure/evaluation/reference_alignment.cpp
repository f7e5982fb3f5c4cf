#include "loopclosure/evaluation/reference_alignment.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kSourcePoints = 10000;
constexpr int kIterationsPerRadius = 100;
constexpr double kStill = 3e-4;  // m and rad of a step; point-to-point ICP creeps
constexpr std::size_t kLeastCorrespondences = 100;
constexpr std::size_t kGlanceStride = 32;

// x, y, z in cells, 21 bits each; x varies fastest, so that neighbours along x have keys in a row.
std::uint64_t cell_key(int x, int y, int z) {
  constexpr int kOffset = 1 << 20;
  const auto bits = [](std::int64_t c) { return static_cast<std::uint64_t>(c + kOffset); };
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

OccupiedVoxels::OccupiedVoxels(const Points& points, const Pose& T, double size)
    : size_(size), keys_(std::bit_ceil(2 * points.size() + 2), kEmpty) {
  std::uint64_t last = kEmpty;
  for (const Eigen::Vector3f& point : points) {
    const std::uint64_t key = key_of(point, T, size);
    if (key == kEmpty || key == last) continue;
    last = key;
    std::uint64_t& slot = keys_[slot_of(key)];
    if (slot == key) continue;
    slot = key;
    ++count_;
  }
}

std::uint64_t OccupiedVoxels::key_of(const Eigen::Vector3f& point, const Pose& T, double size) {
  if (!point.allFinite()) return kEmpty;
  const Eigen::Vector3d p = T * point.cast<double>().eval();
  return cell_key(cell_of(p.x(), size), cell_of(p.y(), size), cell_of(p.z(), size));
}

// The slot that holds `key`, or the empty one where it belongs; the table is never full.
std::size_t OccupiedVoxels::slot_of(std::uint64_t key) const {
  const std::size_t mask = keys_.size() - 1;
  std::size_t slot = ((key * 0x9e3779b97f4a7c15ULL) >> 20) & mask;
  while (keys_[slot] != key && keys_[slot] != kEmpty) slot = (slot + 1) & mask;
  return slot;
}

double OccupiedVoxels::overlap(const Points& other, const Pose& T) const {
  // Most pairs of a drive are nowhere near each other, which a part of the points shows.
  const auto taken = [&](const Eigen::Vector3f& p) {
    const std::uint64_t key = key_of(p, T, size_);
    return key != kEmpty && keys_[slot_of(key)] == key;
  };
  bool near = other.size() < 100 * kGlanceStride;
  for (std::size_t i = 0; i < other.size() && !near; i += kGlanceStride) near = taken(other[i]);
  if (!near) return 0.0;
  const OccupiedVoxels moved(other, T, size_);
  const std::size_t smaller = std::min(count_, moved.count_);
  if (smaller == 0) return 0.0;
  std::size_t shared = 0;
  for (const std::uint64_t key : moved.keys_) {
    shared += key != kEmpty && keys_[slot_of(key)] == key ? 1 : 0;
  }
  return static_cast<double>(shared) / static_cast<double>(smaller);
}

double reference_overlap(const Points& reference, const Points& query,
                         const Pose& T_query_reference, double voxel_size) {
  return OccupiedVoxels(query, Pose(), voxel_size).overlap(reference, T_query_reference);
}

ReferenceTarget::ReferenceTarget(const Points& points) {
  points_.reserve(points.size());
  std::copy_if(points.begin(), points.end(), std::back_inserter(points_),
               [](const Eigen::Vector3f& p) { return p.allFinite(); });
  split(0, points_.size());
}

// Halves points_[begin, end) across the longer side of their box until few are left. The tree is
// implicit: the point in the middle of a range divides it, along the axis that axes_ holds there.
void ReferenceTarget::split(std::size_t begin, std::size_t end) {
  if (axes_.empty()) axes_.assign(points_.size(), 0);
  if (end - begin <= kLeaf) return;
  Eigen::AlignedBox3f box;
  for (std::size_t i = begin; i < end; ++i) box.extend(points_[i]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
  axes_[middle] = static_cast<std::uint8_t>(axis);
  split(begin, middle);
  split(middle + 1, end);
}

void ReferenceTarget::search(const Eigen::Vector3f& p, std::size_t begin, std::size_t end,
                             Nearest& best) const {
  const auto compare = [&](std::size_t i) {
    const float squared = (points_[i] - p).squaredNorm();
    if (squared < best.squared) best = {i, squared};
  };
  if (end - begin <= kLeaf) {
    for (std::size_t i = begin; i < end; ++i) compare(i);
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const auto axis = static_cast<Eigen::Index>(axes_[middle]);
  const float beyond = p[axis] - points_[middle][axis];
  const bool below = beyond < 0;
  if (below) search(p, begin, middle, best);
  if (!below) search(p, middle + 1, end, best);
  if (beyond * beyond >= best.squared) return;
  compare(middle);
  if (below) search(p, middle + 1, end, best);
  if (!below) search(p, begin, middle, best);
}

std::optional<std::size_t> ReferenceTarget::nearest(const Eigen::Vector3f& p, float radius,
                                                    std::optional<std::size_t> guess) const {
  Nearest best{points_.size(), radius * radius};
  if (guess) {
    const float squared = (points_[*guess] - p).squaredNorm();
    if (squared < best.squared) best = {*guess, squared};
  }
  search(p, 0, points_.size(), best);
  if (best.index == points_.size()) return std::nullopt;
  return best.index;
}

ReferenceAlignment reference_alignment(const ReferenceTarget& query, const Points& reference,
                                       const Pose& T_query_reference_initial) {
  ReferenceAlignment result;
  result.T_query_reference = T_query_reference_initial;
  const std::size_t stride = std::max<std::size_t>(1, reference.size() / kSourcePoints);
  const std::size_t count = (reference.size() + stride - 1) / stride;
  std::vector<std::optional<std::size_t>> nearest(count);
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
              if (!moved.allFinite()) continue;
              nearest[i] = query.nearest(moved, radius, nearest[i]);
              if (!nearest[i]) continue;
              const Eigen::Vector3d p = moved.cast<double>();
              const Eigen::Vector3d q = query.points()[*nearest[i]].cast<double>();
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
      still = log_se3(step).norm() < kStill;
    }
    result.converged = still;
  }
  result.T_query_reference = T;
  return result;
}

}  // namespace groundloop
