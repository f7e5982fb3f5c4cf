#include "backend/registration/voxel_pyramid.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "backend/registration/cell_moments.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

struct Cells {
  VoxelTable index;
  std::vector<Eigen::Vector3i> cells;
  std::vector<CellMoments> moments;

  CellMoments& at(const Eigen::Vector3i& cell, VoxelKey key) {
    const auto next = static_cast<std::uint32_t>(moments.size());
    const std::uint32_t number = index.find_or_insert(key, next);
    if (number == next) {
      moments.emplace_back();
      cells.push_back(cell);
    }
    return moments[number];
  }
};

Cells collect(const Points& points, float voxel_size) {
  Cells result{VoxelTable(points.size() / 4), {}, {}};
  const float inverse = 1.0F / voxel_size;
  for (const Eigen::Vector3f& p : points) {
    if (!has_voxel(p)) continue;
    const Eigen::Vector3i cell = voxel_of(p, inverse);
    result.at(cell, voxel_key(cell)).add(p);
  }
  return result;
}

Cells halve(const Cells& fine) {
  Cells result{VoxelTable(fine.cells.size() / 2), {}, {}};
  for (std::size_t i = 0; i < fine.cells.size(); ++i) {
    // An arithmetic shift rounds down, also below zero.
    const Eigen::Vector3i cell(fine.cells[i].x() >> 1, fine.cells[i].y() >> 1,
                               fine.cells[i].z() >> 1);
    result.at(cell, voxel_key(cell)) += fine.moments[i];
  }
  return result;
}

// CellMoments of a cell and the 26 around it: single cells of the finest level hold too few points.
CellMoments neighbourhood(const Cells& cells, std::size_t i) {
  CellMoments sum;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const VoxelKey key = voxel_key(cells.cells[i] + Eigen::Vector3i(x, y, z));
        const std::uint32_t number = cells.index.find(key);
        if (number != VoxelTable::kNone) sum += cells.moments[number];
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
  level.normal_variances.assign(cells.moments.size(), 0.0F);
  parallel_for(cells.moments.size(), 512, [&](std::size_t i) {
    const CellMoments moments = finest ? neighbourhood(cells, i) : cells.moments[i];
    if (moments.count() < kMinPoints) return;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments.covariance());
    const Eigen::Vector3d values = solver.eigenvalues();
    if (!(values[1] > 0.0) || values[0] > kMaxThickness * values[1]) return;
    level.normals[i] = solver.eigenvectors().col(0).normalized().cast<float>();
    // First-order perturbation of the eigenvector towards the next one (Anderson 1963).
    const double variance = std::max(0.0, values[0]);
    level.variances[i] = static_cast<float>(variance);
    level.normal_variances[i] = static_cast<float>(
        variance * values[1] / (moments.count() * (values[1] - variance) * (values[1] - variance)));
  });
}

}  // namespace

VoxelPyramid::VoxelPyramid(const Points& points, double voxel_size, int levels, bool planes) {
  Cells cells = collect(points, static_cast<float>(voxel_size));
  for (int i = 0; i < levels; ++i) {
    if (i > 0) cells = halve(cells);
    VoxelLevel level;
    level.voxel_size = static_cast<float>(voxel_size * std::pow(2.0, i));
    level.means.reserve(cells.moments.size());
    for (const CellMoments& m : cells.moments) level.means.emplace_back(m.mean().cast<float>());
    if (planes) fit_planes(cells, i == 0, level);
    level.index = cells.index;
    levels_.push_back(std::move(level));
  }
}

}  // namespace groundloop
