// Planes fitted to the points of a voxel: the surfaces that odometry registers against.
#pragma once

#include <array>

#include <Eigen/Core>

namespace groundloop {

/// A plane through `point` (m) across the unit vector `normal`; none where the normal is zero.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Vector3f point = Eigen::Vector3f::Zero();

  [[nodiscard]] bool exists() const { return normal.squaredNorm() > 0.5F; }
  [[nodiscard]] float distance(const Eigen::Vector3f& p) const { return normal.dot(p - point); }
};

/// Sums from which a plane follows. Points are taken relative to a place nearby, so that floats
/// suffice however far that is from the origin.
struct PlaneMoments {
  float count = 0.0F;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  std::array<float, 6> products{};  ///< xx, xy, xz, yy, yz, zz

  void add(const Eigen::Vector3f& d) {
    count += 1.0F;
    sum += d;
    products[0] += d.x() * d.x();
    products[1] += d.x() * d.y();
    products[2] += d.x() * d.z();
    products[3] += d.y() * d.y();
    products[4] += d.y() * d.z();
    products[5] += d.z() * d.z();
  }
};

/// What counts as a plane.
struct PlaneLimits {
  float min_points;
  float max_thickness;  ///< m, standard deviation across the plane
  float min_spread;     ///< m, standard deviation along it, in both directions: a line is no plane
};

/// The plane through the points of `moments`, which are relative to `origin` (m); one that does not
/// exist() where the limits are not met.
[[nodiscard]] Plane fit_plane(const PlaneMoments& moments, const Eigen::Vector3f& origin,
                              const PlaneLimits& limits);

}  // namespace groundloop
