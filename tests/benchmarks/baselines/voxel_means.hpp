// One point for each occupied voxel: the mean of those in it, in the order of the voxels.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include "frontend/core/scan.hpp"

namespace groundloop::baselines {

using VoxelIndex = std::array<long, 3>;

[[nodiscard]] inline VoxelIndex voxel_of(const Eigen::Vector3d& p, double size) {
  return {std::lround(std::floor(p.x() / size)), std::lround(std::floor(p.y() / size)),
          std::lround(std::floor(p.z() / size))};
}

[[nodiscard]] inline Points voxel_means(const Points& points, double size) {
  struct Sum {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t count = 0;
  };
  std::map<VoxelIndex, Sum> voxels;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>();
    Sum& voxel = voxels[voxel_of(p, size)];
    voxel.sum += p;
    ++voxel.count;
  }
  Points means;
  for (const auto& [index, voxel] : voxels) {
    means.push_back((voxel.sum / static_cast<double>(voxel.count)).cast<float>());
  }
  return means;
}

}  // namespace groundloop::baselines
