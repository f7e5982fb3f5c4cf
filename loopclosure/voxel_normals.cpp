#include "loopclosure/voxel_normals.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

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

// Open addressing from a voxel's key to its index.
class KeyTable {
 public:
  explicit KeyTable(std::size_t expected) {
    std::size_t capacity = 1024;
    while (capacity < 2 * expected) capacity *= 2;
    slots_.assign(capacity, Slot{});
  }
  // The index stored for `key`, or `next` after storing it.
  std::uint32_t find_or_insert(std::uint64_t key, std::uint32_t next) {
    if (2 * next >= slots_.size()) grow();
    Slot& slot = find(key);
    if (slot.index == kEmpty) slot = {key, next};
    return slot.index;
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffU;
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t index = kEmpty;
  };
  Slot& find(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = (key * 0x9e3779b97f4a7c15ULL) >> 20;
    while (slots_[i & mask].index != kEmpty && slots_[i & mask].key != key) ++i;
    return slots_[i & mask];
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.index != kEmpty) find(slot.key) = slot;
    }
  }
  std::vector<Slot> slots_;
};

}  // namespace

VoxelNormals::VoxelNormals(const Points& points, double size) {
  const auto inverse = static_cast<float>(1.0 / size);
  const auto edge = static_cast<float>(size);
  KeyTable table(points.size() / 8);
  std::vector<Eigen::Vector3f> corners;
  std::uint64_t last_key = ~0ULL;  // no key has its upper bit set
  std::uint32_t index = 0;
  for (const Eigen::Vector3f& p : points) {
    if (!usable(p)) continue;
    const auto i = static_cast<std::int64_t>(std::floor(p.x() * inverse));
    const auto j = static_cast<std::int64_t>(std::floor(p.y() * inverse));
    const auto k = static_cast<std::int64_t>(std::floor(p.z() * inverse));
    constexpr std::int64_t kOffset = 1 << 20;
    const std::uint64_t key = (static_cast<std::uint64_t>(i + kOffset) << 42) |
                              (static_cast<std::uint64_t>(j + kOffset) << 21) |
                              static_cast<std::uint64_t>(k + kOffset);
    if (key != last_key) {
      index = table.find_or_insert(key, static_cast<std::uint32_t>(moments_.size()));
      if (index == moments_.size()) {
        moments_.emplace_back();
        corners.emplace_back(static_cast<float>(i) * edge, static_cast<float>(j) * edge,
                             static_cast<float>(k) * edge);
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
