// Sums from which mean and covariance of the points of a cell follow; cells merge by adding them.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace groundloop {

/// Moments of the points of a cell about the map's origin: count, x y z, xx xy xz yy yz zz.
struct CellMoments {
  std::array<double, 10> m{};

  void add(const Eigen::Vector3f& point) {
    const double x = point.x();
    const double y = point.y();
    const double z = point.z();
    const std::array<double, 10> one{1.0, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
    for (std::size_t k = 0; k < m.size(); ++k) m[k] += one[k];
  }
  CellMoments& operator+=(const CellMoments& other) {
    for (std::size_t k = 0; k < m.size(); ++k) m[k] += other.m[k];
    return *this;
  }
  [[nodiscard]] double count() const { return m[0]; }
  [[nodiscard]] Eigen::Vector3d mean() const { return {m[1] / m[0], m[2] / m[0], m[3] / m[0]}; }
  [[nodiscard]] Eigen::Matrix3d covariance() const {
    const Eigen::Vector3d c = mean();
    Eigen::Matrix3d squares;
    squares << m[4], m[5], m[6], m[5], m[7], m[8], m[6], m[8], m[9];
    return squares / m[0] - c * c.transpose();
  }
};

}  // namespace groundloop
