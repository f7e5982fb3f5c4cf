// Scans of the simulation against closed forms and against its own ground truth.
#include <cmath>

#include <gtest/gtest.h>

#include "frontend/simulation/ray_caster.hpp"
#include "frontend/simulation/simulation.hpp"
#include "frontend/simulation/terrain.hpp"
#include "tests/support/wall_thickness.hpp"

namespace groundloop {
namespace {

using ::groundloop::testing::wall_thickness;
using simulation::Hit;
using simulation::Ray;

/// A level floor at z = 1 and a box from (10, -2, 1) to (14, 2, 5) on it.
class Yard final : public simulation::World {
 public:
  double ground(const simulation::Vec2&) const override { return 1.0; }
  double chunk_size() const override { return 50.0; }
  double overhang() const override { return 20.0; }
  void build(const simulation::ChunkId& chunk, simulation::Mesh& mesh) const override {
    simulation::add_terrain(
        mesh, 50.0 * simulation::Vec2(chunk.i, chunk.j), 50.0, 5.0, [](const auto&) { return 1.0; },
        [](const auto&) { return simulation::Material::grass; });
    if (chunk == simulation::ChunkId{0, 0}) {
      add_box(mesh, simulation::Place{}, {10, -2, 1}, {14, 2, 5}, simulation::Material::brick);
    }
  }
  simulation::Way plan(const SimulationParameters&) const override { return {}; }
};

TEST(RayCaster, MeetsPlanesWhereTheClosedFormSays) {
  const Yard yard;
  simulation::RayCaster caster(yard);
  const Eigen::Vector3d centre(3.0, 0.5, 2.7);
  caster.prepare(centre, 60.0, {});
  int on_box = 0, on_floor = 0;
  for (int i = -40; i <= 40; ++i) {
    for (int j = -30; j <= 10; ++j) {
      const double a = 0.01 * i + 0.0013, e = 0.02 * j + 0.0017;
      const Eigen::Vector3d d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      const Hit hit = caster.cast({Eigen::Vector3f::Zero(), d.cast<float>(), 0.0F}, 50.0F);
      const double floor = d.z() < 0.0 ? (1.0 - centre.z()) / d.z() : INFINITY;
      const double wall = (10.0 - centre.x()) / d.x();
      const Eigen::Vector3d at_wall = centre + wall * d;
      const bool meets = std::abs(at_wall.y()) < 2.0 && at_wall.z() > 1.0 && at_wall.z() < 5.0;
      const double expected = meets ? wall : floor;
      if (expected > 50.0) continue;
      if (!meets && std::abs(at_wall.y()) < 2.01) continue;  // the box's lid and edges
      EXPECT_NEAR(hit.range, expected, 1e-4 * expected) << i << " " << j;
      EXPECT_NEAR(
          std::abs(hit.normal.dot(meets ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitZ())),
          1.0, 1e-5);
      (meets ? on_box : on_floor) += 1;
    }
  }
  EXPECT_GT(on_box, 100);
  EXPECT_GT(on_floor, 100);
}

TEST(RayCaster, MeetsAMovingBodyWhereItIsAtTheRaysTime) {
  const Yard yard;
  simulation::RayCaster caster(yard);
  simulation::Mesh cube;
  add_box(cube, simulation::Place{}, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5},
          simulation::Material::paint);
  simulation::MovingBody body;
  body.shape = caster.add_shape(cube);
  body.start.translation = {-10, 0, 3};
  body.end.translation = {-8, 0, 3};
  caster.prepare({0, 0, 3}, 60.0, std::vector{body});
  for (const float time : {0.0F, 0.25F, 0.7F, 1.0F}) {
    const Hit hit = caster.cast({Eigen::Vector3f::Zero(), -Eigen::Vector3f::UnitX(), time}, 50.0F);
    EXPECT_TRUE(hit.moving);
    EXPECT_NEAR(hit.range, 9.5F - 2.0F * time, 1e-4F);
  }
}

TEST(SimulatedScan, WithoutNoiseWallsAreFlatOnlyByTheTimesOfTheirPoints) {
  const auto recording = open_simulation("sim:town?seed=4&length=200&noise=0");
  const auto exact = wall_thickness(*recording, 30, 5, 12, true);
  const auto skewed = wall_thickness(*recording, 30, 5, 12, false);
  ASSERT_GT(exact.walls, 5U);
  EXPECT_LT(exact.rms, 0.001);
  EXPECT_GT(skewed.rms, 20 * exact.rms);
  EXPECT_GT(skewed.rms, 0.01);
}

TEST(SimulatedScan, WallsAreAsThinAsTheErrorsOfTheSensor) {
  const auto recording = open_simulation("sim:town?seed=4&length=200");
  const auto exact = wall_thickness(*recording, 30, 5, 12, true);
  ASSERT_GT(exact.walls, 5U);
  // Of one echo: noise of 12 mm and more with range and slant, 15 mm by beam, angles of the order
  // of 0.15 degrees.
  EXPECT_GT(exact.rms, 0.012);
  EXPECT_LT(exact.rms, 0.06);
}

TEST(SimulatedScan, RangesAreWithoutErrorWhereNoiseIsZero) {
  const auto recording = open_simulation("sim:town?seed=4&length=100&noise=0&sensor=spin32");
  std::vector<PointTruth> truth;
  const Scan scan = recording->read_with_truth(10, truth);
  ASSERT_EQ(truth.size(), scan.points.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(scan.points[i].norm(), truth[i].range, 1e-5F * truth[i].range);
    EXPECT_TRUE(truth[i].true_echo);
  }
}

TEST(SimulatedScan, NoiseGrowsWithItsFactor) {
  double before = 0.0;
  for (const char* noise : {"0.5", "1", "2"}) {
    const auto recording =
        open_simulation(std::string("sim:town?seed=4&length=100&noise=") + noise);
    std::vector<PointTruth> truth;
    const Scan scan = recording->read_with_truth(10, truth);
    double sum = 0.0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (!truth[i].true_echo) continue;
      const double error = scan.points[i].norm() - truth[i].range;
      sum += error * error;
      ++n;
    }
    const double rms = std::sqrt(sum / static_cast<double>(n));
    EXPECT_GT(rms, 1.5 * before);
    before = rms;
  }
}

}  // namespace
}  // namespace groundloop
