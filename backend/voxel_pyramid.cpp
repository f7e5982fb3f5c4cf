#include "backend/voxel_pyramid.hpp"

#include <bit>

#include <Eigen/Eigenvalues>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// Zeroth, first and second moments of the points of a cell, about the map's origin.
struct Moments {
  double count = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  // xx, xy, xz, yy, yz, zz
  Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();

  void add(const Eigen::Vector3d& p) {
    count += 1.0;
    sum += p;
    squares[0] += p.x() * p.x();
    squares[1] += p.x() * p.y();
    squares[2] += p.x() * p.z();
    squares[3] += p.y() * p.y();
    squares[4] += p.y() * p.z();
    squares[5] += p.z() * p.z();
  }
  Moments& operator+=(const Moments& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
    return *this;
  }
  [[nodiscard]] Eigen::Vector3d mean() const { return sum / count; }
  [[nodiscard]] Eigen::Matrix3d covariance() const {
    const Eigen::Vector3d m = mean();
    Eigen::Matrix3d c;
    c << squares[0], squares[1], squares[2], squares[1], squares[3], squares[4], squares[2],
        squares[4], squares[5];
    return c / count - m * m.transpose();
  }
};

struct Cells {
  VoxelIndex index;
  std::vector<Eigen::Vector3i> cells;
  std::vector<Moments> moments;

  Moments& at(const Eigen::Vector3i& cell, VoxelKey key) {
    const auto number = static_cast<std::size_t>(index.insert(key));
    if (number == moments.size()) {
      moments.emplace_back();
      cells.push_back(cell);
    }
    return moments[number];
  }
};

Cells collect(const Points& points, float voxel_size) {
  Cells result{VoxelIndex(points.size() / 4), {}, {}};
  const float inverse = 1.0F / voxel_size;
  for (const Eigen::Vector3f& p : points) {
    if (!p.allFinite()) continue;
    const Eigen::Vector3i cell = voxel_cell(p, inverse);
    const VoxelKey key = voxel_key(cell);
    if (key != kNoVoxel) result.at(cell, key).add(p.cast<double>());
  }
  return result;
}

Cells halve(const Cells& fine) {
  Cells result{VoxelIndex(fine.cells.size() / 2), {}, {}};
  for (std::size_t i = 0; i < fine.cells.size(); ++i) {
    // An arithmetic shift rounds down, also below zero.
    const Eigen::Vector3i cell(fine.cells[i].x() >> 1, fine.cells[i].y() >> 1,
                               fine.cells[i].z() >> 1);
    result.at(cell, voxel_key(cell)) += fine.moments[i];
  }
  return result;
}

// Moments of a cell and the 26 around it: single cells of the finest level hold too few points.
Moments neighbourhood(const Cells& cells, std::size_t i) {
  Moments sum;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const VoxelKey key = voxel_key(cells.cells[i] + Eigen::Vector3i(x, y, z));
        if (key == kNoVoxel) continue;
        const int number = cells.index.find(key);
        if (number >= 0) sum += cells.moments[static_cast<std::size_t>(number)];
      }
    }
  }
  return sum;
}

void fit_planes(const Cells& cells, bool finest, VoxelLevel& level) {
  constexpr double kMinPoints = 6.0;
  // A surface is at least twice as wide as thick, in both directions.
  constexpr double kMaxThickness = 0.25;
  level.normals.assign(cells.moments.size(), Eigen::Vector3f::Zero());
  level.variances.assign(cells.moments.size(), 0.0F);
  parallel_for(cells.moments.size(), 512, [&](std::size_t i) {
    const Moments moments = finest ? neighbourhood(cells, i) : cells.moments[i];
    if (moments.count < kMinPoints) return;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments.covariance());
    const Eigen::Vector3d values = solver.eigenvalues();
    if (!(values[1] > 0.0) || values[0] > kMaxThickness * values[1]) return;
    level.normals[i] = solver.eigenvectors().col(0).normalized().cast<float>();
    level.variances[i] = static_cast<float>(std::max(0.0, values[0]));
  });
}

}  // namespace

VoxelIndex::VoxelIndex(std::size_t expected) {
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(16, 2 * expected));
  slots_.resize(capacity);
  mask_ = capacity - 1;
  shift_ = 64 - std::countr_zero(capacity);
}

int VoxelIndex::insert(VoxelKey key) {
  if (2 * (size_ + 1) > slots_.size()) grow();
  std::size_t slot = slot_of(key);
  for (; slots_[slot].key != kNoVoxel; slot = (slot + 1) & mask_) {
    if (slots_[slot].key == key) return slots_[slot].number;
  }
  slots_[slot] = {key, static_cast<int>(size_++)};
  return slots_[slot].number;
}

void VoxelIndex::grow() {
  const std::vector<Slot> old = std::move(slots_);
  slots_.assign(2 * old.size(), Slot{});
  mask_ = slots_.size() - 1;
  --shift_;
  for (const Slot& s : old) {
    if (s.key == kNoVoxel) continue;
    std::size_t slot = slot_of(s.key);
    while (slots_[slot].key != kNoVoxel) slot = (slot + 1) & mask_;
    slots_[slot] = s;
  }
}

VoxelPyramid::VoxelPyramid(const Points& points, double voxel_size, int levels, bool planes) {
  Cells cells = collect(points, static_cast<float>(voxel_size));
  for (int i = 0; i < levels; ++i) {
    if (i > 0) cells = halve(cells);
    VoxelLevel level;
    level.voxel_size = static_cast<float>(voxel_size * std::pow(2.0, i));
    level.means.reserve(cells.moments.size());
    for (const Moments& m : cells.moments) level.means.push_back(m.mean().cast<float>());
    if (planes) fit_planes(cells, i == 0, level);
    level.index = cells.index;
    levels_.push_back(std::move(level));
  }
}

}  // namespace groundloop
