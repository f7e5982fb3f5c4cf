// A street block for tests of registration: ground, facades at uneven distances, cars and trunks,
// sampled at random with a known noise. Two samplings of one scene share surfaces but no point.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop::testing {

class StreetScene {
 public:
  /// Two scenes of different seeds have different houses.
  explicit StreetScene(std::uint32_t seed) {
    std::mt19937 generator(seed);
    for (const double side : {-1.0, 1.0}) {
      for (double x = -70.0; x < 70.0;) {
        const double width = 6.0 + 10.0 * unit(generator);
        const double set_back = 8.0 + 6.0 * unit(generator);
        const double height = 4.0 + 6.0 * unit(generator);
        add(x, x + width, side * set_back, side * set_back, 0.0, height);  // facade
        add(x, x, side * set_back, side * (set_back + 6.0), 0.0, height);  // its flanks
        add(x + width, x + width, side * set_back, side * (set_back + 6.0), 0.0, height);
        if (unit(generator) < 0.5) box(x + 2.0, side * 5.0, 4.0, 1.8, 1.5);  // a parked car
        x += width + 4.0 * unit(generator);
      }
    }
    add(-75.0, 75.0, -20.0, 20.0, 0.0, 0.0);  // ground
  }

  /// `n` points of Gaussian noise `sigma` (m) in the scene's frame.
  [[nodiscard]] Points sample(std::size_t n, double sigma, std::uint32_t seed) const {
    std::mt19937 generator(seed);
    double total = 0.0;
    for (const Patch& patch : patches_) total += patch.area;
    Points points;
    while (points.size() < n) {
      double pick = unit(generator) * total;
      const Patch* patch = patches_.data();
      while (pick > patch->area && patch != &patches_.back()) pick -= (patch++)->area;
      const double u = unit(generator);
      const double v = unit(generator);
      Eigen::Vector3d p = patch->corner + patch->u * u + patch->v * v;
      for (int k = 0; k < 3; ++k) {
        double sum = -6.0;
        for (int i = 0; i < 12; ++i) sum += unit(generator);
        p[k] += sigma * sum;
      }
      points.push_back(p.cast<float>());
    }
    return points;
  }

 private:
  struct Patch {
    Eigen::Vector3d corner, u, v;
    double area;
  };

  static double unit(std::mt19937& generator) {
    return static_cast<double>(generator()) / 4294967296.0;
  }
  // An axis-parallel rectangle: one of the three extents is zero.
  void add(double x0, double x1, double y0, double y1, double z0, double z1) {
    const Eigen::Vector3d ex(x1 - x0, 0, 0);
    const Eigen::Vector3d ey(0, y1 - y0, 0);
    const Eigen::Vector3d ez(0, 0, z1 - z0);
    const Eigen::Vector3d u = x1 != x0 ? ex : ey;
    const Eigen::Vector3d v = z1 != z0 ? ez : ey;
    patches_.push_back({Eigen::Vector3d(x0, y0, z0), u, v, u.norm() * v.norm()});
  }
  void box(double x, double y, double length, double width, double height) {
    add(x, x + length, y, y, 0.0, height);
    add(x, x + length, y + width, y + width, 0.0, height);
    add(x, x, y, y + width, 0.0, height);
    add(x + length, x + length, y, y + width, 0.0, height);
    add(x, x + length, y, y + width, height, height);
  }

  std::vector<Patch> patches_;
};

inline Points transformed(const Points& points, const Pose& T) {
  Points result;
  for (const Eigen::Vector3f& p : points) {
    result.push_back((T * Eigen::Vector3d(p.cast<double>())).cast<float>());
  }
  return result;
}

}  // namespace groundloop::testing
