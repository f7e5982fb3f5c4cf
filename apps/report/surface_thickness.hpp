// How thick surfaces are in the cells of a grid: of all points in a cube of 1 m, the standard
// deviation across their best plane. A wall that a wrong solution drew twice is as thick as the two
// are apart. Only cubes that hold a point to be shown are measured.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/voxel_table.hpp"

namespace groundloop::apps {

class SurfaceThickness {
 public:
  /// Measures the cube of `position` (m).
  void ask(const Eigen::Vector3f& position);
  /// A point of the map, m.
  void add(const Eigen::Vector3f& position);
  /// Of the cube of `position`, m; negative where its points are too few or no surface.
  [[nodiscard]] float at(const Eigen::Vector3f& position) const;

 private:
  /// Sums over a cube's points, about its centre.
  struct Cube {
    float count = 0.0F;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix<float, 6, 1> squares = Eigen::Matrix<float, 6, 1>::Zero();
  };
  VoxelTable index_;
  std::vector<Cube> cubes_;
};

}  // namespace groundloop::apps
