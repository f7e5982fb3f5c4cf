#include "backend/registration/vertical.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "backend/registration/cell_moments.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {
namespace {

constexpr float kCell = 1.0F;           // m
constexpr double kMinPoints = 8;        // of a cell
constexpr double kMaxThickness = 0.06;  // m, standard deviation across the plane
constexpr double kMinSpread = 0.2;      // m, along its shorter side
constexpr std::size_t kMinSurfaces = 30;
// Gates around the horizontal, narrowing from what a slope of the ground may turn the start by.
constexpr double kGates[] = {20, 15, 10, 6, 5, 5, 5, 5, 5};  // degrees

// Unit normals of the cells that hold one plane.
std::vector<Eigen::Vector3d> plane_normals(const Points& points) {
  VoxelTable index(points.size() / 16);
  std::vector<CellMoments> cells;
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite() || point.cwiseAbs().maxCoeff() > 1e4F) continue;
    const auto next = static_cast<std::uint32_t>(cells.size());
    const std::uint32_t number = index.find_or_insert(voxel_key(voxel_of(point, 1 / kCell)), next);
    if (number == next) cells.emplace_back();
    cells[number].add(point);
  }
  std::vector<Eigen::Vector3d> normals;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (const CellMoments& cell : cells) {
    if (cell.count() < kMinPoints) continue;
    solver.computeDirect(cell.covariance());
    if (solver.eigenvalues()(0) > kMaxThickness * kMaxThickness ||
        solver.eigenvalues()(1) < kMinSpread * kMinSpread)
      continue;
    normals.emplace_back(solver.eigenvectors().col(0));
  }
  return normals;
}

// The prevailing normal of the surfaces within 60 degrees of `start`: the ground's.
Eigen::Vector3d ground_normal(const std::vector<Eigen::Vector3d>& normals) {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const double gate : {60.0, 40.0, 25.0, 15.0, 15.0}) {
    const double cosine = std::cos(gate * M_PI / 180.0);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& n : normals) {
      if (std::abs(n.dot(up)) > cosine) sum += n * n.transpose();
    }
    if (sum.isZero(0.0)) break;
    const Eigen::Vector3d axis =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(2);
    up = axis.dot(up) < 0 ? Eigen::Vector3d(-axis) : axis;
  }
  return up;
}

}  // namespace

MapVertical find_vertical(const Points& map_points) {
  const std::vector<Eigen::Vector3d> normals = plane_normals(map_points);
  MapVertical result;
  result.up = ground_normal(normals);
  Eigen::Matrix3d sum;
  double weights = 0.0;
  double squares = 0.0;
  for (const double gate : kGates) {
    const double limit = std::sin(gate * M_PI / 180.0);
    sum.setZero();
    weights = squares = 0.0;
    result.surfaces = 0;
    for (const Eigen::Vector3d& n : normals) {
      const double c = n.dot(result.up) / limit;
      if (std::abs(c) >= 1.0) continue;
      const double weight = (1 - c * c) * (1 - c * c);  // Tukey's
      sum += weight * n * n.transpose();
      weights += weight;
      squares += weight * c * c * limit * limit;
      ++result.surfaces;
    }
    if (result.surfaces < kMinSurfaces) return {result.up};
    const Eigen::Vector3d axis =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(0);
    result.up = axis.dot(result.up) < 0 ? Eigen::Vector3d(-axis) : axis;
  }
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - result.up * result.up.transpose();
  const double variance = std::max(squares / weights, 1e-6);
  result.information = across * sum * across / variance;
  return result;
}

}  // namespace groundloop
