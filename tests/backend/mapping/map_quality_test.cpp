#include "backend/mapping/map_quality.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/street_scene.hpp"

namespace groundloop {
namespace {

Pose shifted(double x, double y, double z) {
  Pose pose;
  pose.translation = {x, y, z};
  return pose;
}

// A level square of 30 m with its points spread evenly.
Points floor_at(float z, std::uint32_t seed) {
  std::mt19937 generator(seed);
  Points points;
  for (int i = 0; i < 60000; ++i) {
    const auto x = static_cast<float>(generator()) / 4294967296.0F;
    const auto y = static_cast<float>(generator()) / 4294967296.0F;
    points.emplace_back(30.0F * x, 30.0F * y, z);
  }
  return points;
}

TEST(RevisitQuality, ThicknessIsTheDistanceOfTwoFloors) {
  const Points query = floor_at(0.25F, 1);
  const RegistrationTarget target(query, {});
  for (const double gap : {0.0, 0.1, 0.2}) {
    const RevisitQuality quality =
        revisit_quality(target, query, floor_at(0.25F, 2), shifted(0, 0, gap));
    EXPECT_NEAR(quality.plane_thickness, gap, 0.002);
    EXPECT_GT(quality.cells, 3000U);
  }
}

TEST(RevisitQuality, EntropyIsThatOfTheCellsPoints) {
  // In a full cell of 1 m: variance 1/12 along x and y, gap^2/4 along z, and the noise floor.
  const Points query = floor_at(0.25F, 1);
  const RegistrationTarget target(query, {});
  const double gap = 0.2;
  const RevisitQuality quality =
      revisit_quality(target, query, floor_at(0.25F, 2), shifted(0, 0, gap));
  const double level = 1.0 / 12.0 + 1e-4;
  const double expected = 0.5 * (3.0 * std::log(2.0 * std::numbers::pi * std::numbers::e) +
                                 std::log(level * level * (0.25 * gap * gap + 1e-4)));
  EXPECT_NEAR(quality.entropy, expected, 0.03);
}

TEST(RevisitQuality, IsBestAtTheTruePose) {
  const testing::StreetScene scene(1);
  const Points query = scene.sample(60000, 0.02, 1);
  const Points reference = scene.sample(60000, 0.02, 2);
  const RegistrationTarget target(query, {});
  const RevisitQuality best = revisit_quality(target, query, reference, Pose());
  for (const Pose& pose : {shifted(0.3, 0, 0), shifted(0, 0.3, 0), shifted(0, 0, 0.3),
                           shifted(1.5, 0.5, 0), shifted(0, 0, 1.5), shifted(-6, 0, 0)}) {
    const RevisitQuality worse = revisit_quality(target, query, reference, pose);
    EXPECT_GT(worse.plane_thickness, best.plane_thickness) << pose.translation.transpose();
  }
  EXPECT_GT(revisit_quality(target, query, reference, shifted(0.2, 0.2, 0.2)).entropy,
            best.entropy);
}

TEST(RevisitQuality, OfMapsApartIsNothing) {
  const Points query = floor_at(0.0F, 1);
  const RevisitQuality quality =
      revisit_quality(RegistrationTarget(query, {}), query, floor_at(0.0F, 2), shifted(500, 0, 0));
  EXPECT_EQ(quality.cells, 0U);
  EXPECT_EQ(quality.plane_thickness, 0.0);
  const RevisitQuality both = combine(quality, {0.3, -2.0, 10, 5});
  EXPECT_DOUBLE_EQ(both.plane_thickness, 0.3);
  EXPECT_DOUBLE_EQ(both.entropy, -2.0);
}

}  // namespace
}  // namespace groundloop
