#include "apps/report/surface_thickness.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace groundloop::apps {
namespace {

constexpr float kEdge = 1.0F;  // m
constexpr float kFewest = 12.0F;

Eigen::Vector3f from_centre(const Eigen::Vector3f& position) {
  const Eigen::Vector3i cube = voxel_of(position, 1.0F / kEdge);
  return position - (cube.cast<float>().array() + 0.5F).matrix() * kEdge;
}

VoxelKey cube_of(const Eigen::Vector3f& position) {
  return voxel_key(voxel_of(position, 1.0F / kEdge));
}

}  // namespace

void SurfaceThickness::ask(const Eigen::Vector3f& position) {
  const auto next = static_cast<std::uint32_t>(cubes_.size());
  if (index_.find_or_insert(cube_of(position), next) == next) cubes_.emplace_back();
}

void SurfaceThickness::add(const Eigen::Vector3f& position) {
  const std::uint32_t found = index_.find(cube_of(position));
  if (found == VoxelTable::kNone) return;
  const Eigen::Vector3f p = from_centre(position);
  Cube& cube = cubes_[found];
  cube.count += 1.0F;
  cube.sum += p;
  cube.squares += (Eigen::Matrix<float, 6, 1>() << p.x() * p.x(), p.x() * p.y(), p.x() * p.z(),
                   p.y() * p.y(), p.y() * p.z(), p.z() * p.z())
                      .finished();
}

float SurfaceThickness::at(const Eigen::Vector3f& position) const {
  const std::uint32_t found = index_.find(cube_of(position));
  if (found == VoxelTable::kNone || cubes_[found].count < kFewest) return -1.0F;
  const Cube& cube = cubes_[found];
  const Eigen::Vector3f mean = cube.sum / cube.count;
  const Eigen::Matrix<float, 6, 1> s = cube.squares / cube.count;
  Eigen::Matrix3f covariance;
  covariance << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  covariance -= mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
  const Eigen::Vector3f variances = solver.eigenvalues().cwiseMax(0.0F);
  // A line or a bush is no surface: it has to reach across the cube both ways, and be flat.
  constexpr float kReach = 0.12F;  // m, standard deviation
  if (variances[1] < kReach * kReach || variances[0] > 0.5F * variances[1]) return -1.0F;
  return std::sqrt(variances[0]);
}

}  // namespace groundloop::apps
