#include "tests/benchmarks/baselines/plane_voxels.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>

namespace groundloop::baselines {
namespace {

constexpr double kVoxel = 2.0;  // m
constexpr std::size_t kLeastPoints = 10;
constexpr double kFlat = 0.01;  // m^2
constexpr double kNormals = 0.2, kApart = 0.5;
constexpr double kCell = 8.0;  // m, of the search for near planes

void set_normal(FlatVoxel& plane) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(plane.covariance);
  plane.normal = solver.eigenvectors().col(0);
}

}  // namespace

PlaneVoxels plane_voxels(const std::vector<Eigen::Vector3d>& points) {
  PlaneVoxels voxels;
  for (const Eigen::Vector3d& p : points) voxels[voxel_of(p, kVoxel)].points.push_back(p);
  for (auto& [index, voxel] : voxels) {
    if (voxel.points.size() <= kLeastPoints) continue;
    FlatVoxel& plane = voxel.plane;
    plane.points = static_cast<double>(voxel.points.size());
    for (const Eigen::Vector3d& p : voxel.points) plane.centre += p / plane.points;
    for (const Eigen::Vector3d& p : voxel.points) {
      plane.covariance += (p - plane.centre) * (p - plane.centre).transpose() / plane.points;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(plane.covariance);
    plane.normal = solver.eigenvectors().col(0);
    voxel.is_plane = solver.eigenvalues()(0) < kFlat;
  }
  return voxels;
}

std::vector<FlatVoxel> planes_of(const PlaneVoxels& voxels) {
  std::vector<FlatVoxel> planes;
  for (const auto& [index, voxel] : voxels) {
    if (voxel.is_plane) planes.push_back(voxel.plane);
  }
  return planes;
}

FlatVoxel joined(const FlatVoxel& a, const FlatVoxel& b) {
  FlatVoxel sum;
  sum.points = a.points + b.points;
  sum.centre = (a.points * a.centre + b.points * b.centre) / sum.points;
  const auto second = [](const FlatVoxel& v) {
    return Eigen::Matrix3d(v.points * (v.covariance + v.centre * v.centre.transpose()));
  };
  sum.covariance = (second(a) + second(b)) / sum.points - sum.centre * sum.centre.transpose();
  set_normal(sum);
  return sum;
}

bool parallel(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double bound) {
  return (a - b).norm() < bound || (a + b).norm() < bound;
}

double plane_agreement(const std::vector<FlatVoxel>& query, const std::vector<FlatVoxel>& reference,
                       const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  if (query.empty() || reference.empty()) return 0.0;
  std::map<VoxelIndex, std::vector<const FlatVoxel*>> cells;
  for (const FlatVoxel& plane : reference) cells[voxel_of(plane.centre, kCell)].push_back(&plane);
  std::size_t agree = 0;
  for (const FlatVoxel& plane : query) {
    const Eigen::Vector3d centre = rotation * plane.centre + translation;
    const Eigen::Vector3d normal = rotation * plane.normal;
    // The three nearest within 8 m; farther ones can hardly continue it.
    using Near = std::pair<double, const FlatVoxel*>;
    std::array<Near, 3> nearest;
    nearest.fill({std::numeric_limits<double>::infinity(), nullptr});
    const VoxelIndex at = voxel_of(centre, kCell);
    for (long x = -1; x <= 1; ++x) {
      for (long y = -1; y <= 1; ++y) {
        for (long z = -1; z <= 1; ++z) {
          const auto cell = cells.find({at[0] + x, at[1] + y, at[2] + z});
          if (cell == cells.end()) continue;
          for (const FlatVoxel* other : cell->second) {
            const double squared = (other->centre - centre).squaredNorm();
            if (squared >= nearest[2].first) continue;
            nearest[2] = {squared, other};
            std::sort(nearest.begin(), nearest.end(),
                      [](const Near& a, const Near& b) { return a.first < b.first; });
          }
        }
      }
    }
    agree += std::any_of(nearest.begin(), nearest.end(), [&](const Near& near) {
      return near.second != nullptr && parallel(normal, near.second->normal, kNormals) &&
             std::abs(near.second->normal.dot(centre - near.second->centre)) < kApart;
    });
  }
  return static_cast<double>(agree) / static_cast<double>(query.size());
}

}  // namespace groundloop::baselines
