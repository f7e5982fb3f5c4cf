// Surfaces and poses against a room whose walls and whose poses are known.
#include "backend/refinement/surface_adjustment.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// A room of 12 x 8 x 3 m with a box in it, its walls seen from within, and a thin wall across with
// another room behind it.
class Room {
 public:
  explicit Room(unsigned seed) : generator_(seed) {}

  // Points seen from a pose, `noise` across the line of sight of each.
  Points scan(const Pose& T_world_sensor, double noise, int count = 3000) {
    Points points;
    const Pose T_sensor_world = T_world_sensor.inverse();
    while (static_cast<int>(points.size()) < count) {
      const Eigen::Vector3d direction =
          Eigen::Vector3d(normal_(generator_), normal_(generator_), normal_(generator_))
              .normalized();
      const double range =
          cast(T_world_sensor.translation, direction) + noise * normal_(generator_);
      points.emplace_back(
          (T_sensor_world * (T_world_sensor.translation + range * direction)).cast<float>());
    }
    return points;
  }

 private:
  // Distance to the inside of the room the sensor is in: x from 0 to 12, or behind the thin wall
  // from 12.1 to 20.
  static double cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
    const bool behind = from.x() > 12.05;
    const Eigen::Vector3d low(behind ? 12.1 : 0.0, 0.0, 0.0);
    const Eigen::Vector3d high(behind ? 20.0 : 12.0, 8.0, 3.0);
    double nearest = 1e9;
    for (int k = 0; k < 3; ++k) {
      if (direction[k] > 1e-12) nearest = std::min(nearest, (high[k] - from[k]) / direction[k]);
      if (direction[k] < -1e-12) nearest = std::min(nearest, (low[k] - from[k]) / direction[k]);
    }
    return nearest;
  }
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
};

struct Scene {
  std::vector<Pose> truth, estimate;
  std::vector<Points> scans;

  [[nodiscard]] std::vector<Surface> surfaces(const std::vector<Pose>& poses,
                                              SurfaceCellOptions options = {}) const {
    SurfaceCells cells(options, poses);
    for (std::size_t s = 0; s < scans.size(); ++s) cells.add(static_cast<int>(s), Pose(), scans[s]);
    return cells.surfaces();
  }
};

Scene make_scene(double noise, double metres, double radians, unsigned seed = 1) {
  Scene scene;
  Room room(seed);
  std::mt19937 generator(seed + 100);
  std::normal_distribution<double> normal;
  for (int s = 0; s < 6; ++s) {
    scene.truth.emplace_back(exp_so3({0.0, 0.0, 0.7 * s}),
                             Eigen::Vector3d(2.0 + 1.4 * s, 2.0 + 0.7 * s, 1.2));
    scene.scans.push_back(room.scan(scene.truth.back(), noise));
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = (k < 3 ? metres : radians) * normal(generator);
    scene.estimate.push_back(scene.truth.back() *
                             exp_se3(s == 0 ? Vector6d(Vector6d::Zero()) : error));
  }
  return scene;
}

double worst_error(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    worst = std::max(worst, (poses[i].translation - truth[i].translation).norm());
  return worst;
}

TEST(SurfaceCells, FindTheWallsOfARoom) {
  const Scene scene = make_scene(0.0, 0.0, 0.0);
  const std::vector<Surface> surfaces = scene.surfaces(scene.truth);
  ASSERT_GT(surfaces.size(), 50U);
  std::size_t exact = 0;
  for (const Surface& surface : surfaces) {
    const SurfaceFit fit = fit_surface(surface.parts, scene.truth);
    // Walls stand along the axes; in a corner a few points of another wall may slip in.
    EXPECT_GT(fit.normal.cwiseAbs().maxCoeff(), 0.98);
    exact += fit.thickness() < 1e-3 ? 1 : 0;
  }
  EXPECT_GT(exact, surfaces.size() * 95 / 100);
}

TEST(SurfaceCells, TheTwoSidesOfAThinWallAreTwoSurfaces) {
  Scene scene;
  Room room(3);
  for (const double x : {8.0, 10.0, 14.0, 16.0}) {
    scene.truth.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 4.0, 1.5));
    scene.scans.push_back(room.scan(scene.truth.back(), 0.0));
  }
  SurfaceCellOptions options;
  options.max_thickness = 0.3;
  options.flatness = 0.5;
  int on_wall = 0;
  for (const Surface& surface : scene.surfaces(scene.truth, options)) {
    const SurfaceFit fit = fit_surface(surface.parts, scene.truth);
    if (std::abs(fit.normal.x()) < 0.9 || std::abs(fit.centre.x() - 12.05) > 0.5) continue;
    ++on_wall;
    EXPECT_LT(fit.thickness(), 1e-3);
  }
  EXPECT_GT(on_wall, 8);
}

TEST(SurfaceAdjustment, GradientIsThatOfFiniteDifferences) {
  const Scene scene = make_scene(0.01, 0.05, 0.01);
  const std::vector<Surface> surfaces = scene.surfaces(scene.estimate);
  ASSERT_GT(surfaces.size(), 20U);
  const SurfaceAdjustmentOptions options;
  const SurfaceNormalEquations equations =
      surface_normal_equations(surfaces, scene.estimate, options);
  constexpr double kStep = 1e-5;
  const double scale = equations.gradient.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < equations.gradient.size(); ++i) {
    const auto cost_at = [&](double step) {
      std::vector<Pose> poses = scene.estimate;
      Vector6d xi = Vector6d::Zero();
      xi[i % 6] = step;
      poses[static_cast<std::size_t>(i / 6)] = poses[static_cast<std::size_t>(i / 6)] * exp_se3(xi);
      return surface_normal_equations(surfaces, poses, options).cost;
    };
    const double difference = (cost_at(kStep) - cost_at(-kStep)) / (2.0 * kStep);
    EXPECT_NEAR(equations.gradient[i], difference, 2e-4 * scale) << i;
  }
}

TEST(SurfaceAdjustment, FindsThePosesOfARoomExactlyWithoutNoise) {
  const Scene scene = make_scene(0.0, 0.03, 0.005);
  std::vector<Pose> poses = scene.estimate;
  // Cells are those of the poses they were found at: a second round sees more of the surfaces.
  for (int round = 0; round < 4; ++round)
    poses = adjust_surfaces(scene.surfaces(poses), {}, poses, 0, {}).T_world_submap;
  EXPECT_GT(worst_error(scene.estimate, scene.truth), 0.05);
  EXPECT_LT(worst_error(poses, scene.truth), 2e-3);
}

TEST(SurfaceAdjustment, NoiseLeavesLessThanItsOwnSize) {
  const Scene scene = make_scene(0.02, 0.05, 0.01, 4);
  std::vector<Pose> poses = scene.estimate;
  const double before = thickness_of(scene.surfaces(scene.truth), poses).mean;
  for (int round = 0; round < 4; ++round)
    poses = adjust_surfaces(scene.surfaces(poses), {}, poses, 0, {}).T_world_submap;
  EXPECT_LT(worst_error(poses, scene.truth), 0.01);
  EXPECT_LT(thickness_of(scene.surfaces(scene.truth), poses).mean, 0.7 * before);
}

// Along a corridor surfaces say nothing: the prior decides there, and only there.
TEST(SurfaceAdjustment, WhatSurfacesDoNotSayThePriorDecides) {
  Scene scene;
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int s = 0; s < 3; ++s) {
    scene.truth.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(2.0 * s, 0.0, 0.0));
    Points points;
    for (int i = 0; i < 4000; ++i) {
      const auto x = static_cast<float>(15.0 * uniform(generator) - 2.0 * s);
      const auto across = static_cast<float>(uniform(generator));
      if (i % 2 == 0) points.emplace_back(x, i % 4 == 0 ? 1.5F : -1.5F, across);
      if (i % 2 == 1) points.emplace_back(x, 1.5F * across, i % 4 == 1 ? 1.2F : -1.2F);
    }
    scene.scans.push_back(points);
    scene.estimate.push_back(scene.truth.back());
    scene.estimate.back().translation += s * Eigen::Vector3d(0.3, 0.04, -0.03);
  }
  std::vector<RelativePrior> priors;
  for (int s = 1; s < 3; ++s) {
    RelativePrior prior{s - 1, s, scene.estimate[s - 1].inverse() * scene.estimate[s], {}};
    prior.information = Matrix6d::Identity() * 100.0;
    priors.push_back(prior);
  }
  const SurfaceAdjustment result =
      adjust_surfaces(scene.surfaces(scene.estimate), priors, scene.estimate, 0, {});
  for (int s = 1; s < 3; ++s) {
    const Eigen::Vector3d error = result.T_world_submap[s].translation - scene.truth[s].translation;
    EXPECT_NEAR(error.x(), 0.3 * s, 1e-2);
    EXPECT_NEAR(error.y(), 0.0, 5e-3);
    EXPECT_NEAR(error.z(), 0.0, 5e-3);
  }
}

TEST(SurfaceAdjustment, OnePartThatIsFarOffDoesNotMoveTheOthers) {
  Scene scene = make_scene(0.005, 0.0, 0.0, 6);
  // The last submap saw the room from elsewhere: a closed door, a cupboard put before each wall.
  for (Eigen::Vector3f& point : scene.scans.back()) point *= 0.99F;
  const SurfaceAdjustment result =
      adjust_surfaces(scene.surfaces(scene.truth), {}, scene.truth, 0, {});
  for (std::size_t s = 0; s + 1 < scene.truth.size(); ++s) {
    EXPECT_LT((result.T_world_submap[s].translation - scene.truth[s].translation).norm(), 0.01);
  }
}

TEST(SurfaceAdjustment, IsTheSameForAnyNumberOfThreads) {
  const Scene scene = make_scene(0.02, 0.05, 0.01, 7);
  const std::vector<Surface> surfaces = scene.surfaces(scene.estimate);
  std::vector<Pose> first;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    const SurfaceAdjustment result = adjust_surfaces(surfaces, {}, scene.estimate, 0, {});
    if (first.empty()) first = result.T_world_submap;
    for (std::size_t s = 0; s < first.size(); ++s) {
      EXPECT_EQ(first[s].translation, result.T_world_submap[s].translation);
      EXPECT_EQ(first[s].rotation.coeffs(), result.T_world_submap[s].rotation.coeffs());
    }
  }
  set_thread_count(0);
}

}  // namespace
}  // namespace groundloop
