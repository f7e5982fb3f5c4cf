// Which way is up in a local map, told by what stands upright: facades, trunks and poles have
// horizontal normals, and the direction all of them are perpendicular to is the vertical. A slope
// of the ground does not turn it, and neither does a sensor whose beams point a little too high or
// low: that bends the ground it sees into a bowl, but leaves walls upright.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "frontend/core/scan.hpp"

namespace groundloop {

struct MapVertical {
  /// Unit vector in the map's frame, upward (positive along the ground's normal).
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  /// Inverse covariance of `up` (1 / rad^2) from the scatter of the normals as if each were
  /// independent; singular along `up`, and weak across a street whose facades face one way. Zero
  /// where nothing upright was seen.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  std::size_t surfaces = 0;  ///< cells with an upright surface
};

/// `map_points` in metres, in the map's frame, whose z axis points upward to within 60 degrees.
[[nodiscard]] MapVertical find_vertical(const Points& map_points);

}  // namespace groundloop
