#include "frontend/odometry/plane_fit.hpp"

#include <Eigen/Eigenvalues>

namespace groundloop {

Plane fit_plane(const PlaneMoments& moments, const Eigen::Vector3f& origin,
                const PlaneLimits& limits) {
  Plane plane;
  if (moments.count < limits.min_points) return plane;
  const Eigen::Vector3f mean = moments.sum / moments.count;
  const std::array<float, 6>& m = moments.products;
  Eigen::Matrix3f squares;
  squares << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  const Eigen::Matrix3f covariance = squares / moments.count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f variance = solver.eigenvalues();
  if (variance(0) > limits.max_thickness * limits.max_thickness ||
      variance(1) < limits.min_spread * limits.min_spread) {
    return plane;
  }
  plane.normal = solver.eigenvectors().col(0);
  plane.point = origin + mean;
  return plane;
}

}  // namespace groundloop
