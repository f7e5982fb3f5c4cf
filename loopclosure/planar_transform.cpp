#include "loopclosure/planar_transform.hpp"

#include <cmath>

#include "frontend/core/error.hpp"

namespace groundloop {

Pose lift(const PlanarTransform& T) {
  return Pose(exp_so3({0.0, 0.0, T.angle}), {T.translation.x(), T.translation.y(), 0.0});
}

PlanarTransform fit_planar_transform(std::span<const Eigen::Vector2d> a,
                                     std::span<const Eigen::Vector2d> b) {
  check(a.size() == b.size(), "fit_planar_transform takes as many points on either side");
  PlanarTransform T;
  if (a.empty()) return T;
  Eigen::Vector2d mean_a = Eigen::Vector2d::Zero(), mean_b = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i];
    mean_b += b[i];
  }
  mean_a /= static_cast<double>(a.size());
  mean_b /= static_cast<double>(b.size());
  // With H the covariance of b and a, the proper rotation that maximises trace(R H) has this
  // sine and cosine, up to a common factor.
  double cosine = 0.0, sine = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d u = a[i] - mean_a, v = b[i] - mean_b;
    cosine += v.dot(u);
    sine += v.x() * u.y() - v.y() * u.x();
  }
  if (cosine != 0.0 || sine != 0.0) T.angle = std::atan2(sine, cosine);
  T.translation = mean_a - rotation_matrix(T) * mean_b;
  return T;
}

double wrap_angle(double angle) {
  const double wrapped = std::remainder(angle, 2 * M_PI);
  return wrapped <= -M_PI ? wrapped + 2 * M_PI : wrapped;
}

}  // namespace groundloop
