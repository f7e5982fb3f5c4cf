#include "backend/registration/verification.hpp"

#include <random>

#include <gtest/gtest.h>

#include "backend/registration/overlap.hpp"
#include "tests/support/street_scene.hpp"

namespace groundloop {
namespace {

using testing::StreetScene;

Pose shifted(double x, double y, double z) {
  Pose pose;
  pose.translation = {x, y, z};
  return pose;
}

// One point in the middle of each voxel of an n x n x n cube.
Points cube(int n) {
  Points points;
  for (int i = 0; i < n * n * n; ++i) {
    points.emplace_back(0.25F + 0.5F * static_cast<float>(i % n),
                        0.25F + 0.5F * static_cast<float>(i / n % n),
                        0.25F + 0.5F * static_cast<float>(i / n / n));
  }
  return points;
}

TEST(VolumetricOverlap, IsTheSharedShareOfTheSmallerMap) {
  const Points big = cube(10);
  EXPECT_DOUBLE_EQ(volumetric_overlap(big, big, Pose()), 1.0);
  EXPECT_DOUBLE_EQ(volumetric_overlap(big, big, shifted(2.5, 0, 0)), 0.5);
  EXPECT_DOUBLE_EQ(volumetric_overlap(big, big, shifted(100, 0, 0)), 0.0);
  EXPECT_DOUBLE_EQ(volumetric_overlap(cube(4), big, Pose()), 1.0);
  EXPECT_DOUBLE_EQ(volumetric_overlap(big, cube(4), Pose()), 1.0);
  EXPECT_DOUBLE_EQ(volumetric_overlap(big, cube(4), shifted(1.0, 0, 0)), 0.5);
}

TEST(VolumetricOverlap, CountsAVoxelOnceAndEmptyMapsAsNone) {
  Points twice = cube(6);
  twice.insert(twice.end(), twice.begin(), twice.end());
  EXPECT_DOUBLE_EQ(volumetric_overlap(twice, cube(6), shifted(1.5, 0, 0)), 0.5);
  EXPECT_DOUBLE_EQ(volumetric_overlap({}, cube(6), Pose()), 0.0);
  EXPECT_DOUBLE_EQ(volumetric_overlap(cube(6), Points(), Pose()), 0.0);
}

// Columns of 1 m: `tall(i, j)` decides whether points stand 3 m high.
template <typename F>
ColumnGrid grid(int n, F&& tall) {
  Points points;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < 4; ++k) {
        const float z = tall(i, j) ? static_cast<float>(k) : 0.05F * static_cast<float>(k);
        points.emplace_back(0.5F + static_cast<float>(i), 0.5F + static_cast<float>(j), z);
      }
    }
  }
  return {points, Pose(), Eigen::Vector3f::UnitZ()};
}

TEST(ColumnAgreement, IsThePhiCoefficient) {
  const ColumnGrid rows = grid(20, [](int i, int) { return i % 2 == 0; });
  const ColumnGrid columns = grid(20, [](int, int j) { return j % 2 == 0; });
  const ColumnGrid opposite = grid(20, [](int i, int) { return i % 2 == 1; });
  EXPECT_EQ(rows.agreement(rows).shared, 400U);
  EXPECT_DOUBLE_EQ(rows.agreement(rows).correlation, 1.0);
  EXPECT_DOUBLE_EQ(rows.agreement(columns).correlation, 0.0);
  EXPECT_DOUBLE_EQ(rows.agreement(opposite).correlation, -1.0);
}

TEST(ColumnAgreement, IsUndefinedWithoutBothKinds) {
  const ColumnGrid rows = grid(20, [](int i, int) { return i % 2 == 0; });
  const ColumnGrid field = grid(20, [](int, int) { return false; });
  EXPECT_FALSE(rows.agreement(field).defined);
  EXPECT_FALSE(field.agreement(field).defined);
}

// Two kinds at random, the same for the same place.
bool any(int i, int j) {
  return ((static_cast<unsigned>(i) * 73856093U ^ static_cast<unsigned>(j) * 19349663U) *
              2654435761U >>
          16U) %
             2U ==
         0U;
}

TEST(ColumnContrast, TellsAPlaceFromThoseBesideThoughASensorMissesHalfOfIt) {
  const ColumnGrid place = grid(60, any);
  const ColumnGrid poorly = grid(60, [](int i, int j) { return any(i, j) && any(j + 500, i); });
  // A quarter tall against a half, all of them among the half: phi is sqrt(1/3).
  EXPECT_NEAR(place.agreement(poorly).correlation, std::sqrt(1.0 / 3.0), 0.05);
  const ColumnContrast contrast = place.contrast(poorly);
  ASSERT_TRUE(contrast.defined);
  EXPECT_DOUBLE_EQ(contrast.here, place.agreement(poorly).correlation);
  // Unrelated columns correlate by chance only: 1 / sqrt(1600) at the smallest overlap.
  EXPECT_LT(contrast.beside, 5.0 / 40.0);
}

TEST(ColumnContrast, IsNoneWhereTheStructureRepeats) {
  const ColumnGrid rows = grid(60, [](int i, int) { return i % 5 == 0; });
  EXPECT_DOUBLE_EQ(rows.contrast(rows).here, 1.0);
  EXPECT_DOUBLE_EQ(rows.contrast(rows).beside, 1.0);
}

TEST(ColumnContrast, FindsTheBetterPlaceBeside) {
  const ColumnGrid place = grid(60, any);
  const ColumnGrid moved = grid(60, [](int i, int j) { return any(i - 7, j + 3); });
  const ColumnContrast contrast = place.contrast(moved);
  EXPECT_DOUBLE_EQ(contrast.beside, 1.0);
  EXPECT_LT(contrast.margin(), -0.8);
}

class Verification : public ::testing::Test {
 protected:
  RegistrationOptions registration_;
  VerificationOptions options_;
  StreetScene street_{1};
  Points query_ = street_.sample(60000, 0.02, 1);
  RegistrationTarget target_{query_, registration_};
};

TEST_F(Verification, AcceptsTheSamePlace) {
  const Points reference = street_.sample(60000, 0.02, 2);
  const ClosureVerification result =
      verify_closure(target_, query_, reference, shifted(1.0, 0.5, 0.2), options_, registration_);
  EXPECT_EQ(result.status, ClosureStatus::accepted) << result.reason;
  EXPECT_LT(result.T_query_reference.translation.norm(), 0.03);
  EXPECT_NEAR(result.overlap, volumetric_overlap(reference, query_, result.T_query_reference),
              1e-12);
  EXPECT_GT(result.agreement, 0.8);
  EXPECT_TRUE(result.reason.empty());
}

// Poles that stood there on one day only, `n` of them: tall columns that the other day has not.
Points with_poles(Points points, int n, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> along(-70.0F, 70.0F), across(-20.0F, 20.0F), up(0.0F, 4.0F);
  for (int i = 0; i < n; ++i) {
    const float x = along(generator), y = across(generator);
    for (int k = 0; k < 40; ++k) points.emplace_back(x, y, up(generator));
  }
  return points;
}

TEST_F(Verification, AcceptsLessAgreementWhereItStandsOut) {
  const Points query = with_poles(query_, 800, 3);
  const RegistrationTarget target(query, registration_);
  const Points reference = with_poles(street_.sample(60000, 0.02, 2), 800, 4);
  const ClosureVerification result =
      verify_closure(target, query, reference, shifted(1.0, 0.5, 0.2), options_, registration_);
  EXPECT_LT(result.agreement, options_.min_agreement);
  ASSERT_TRUE(result.contrast.has_value());
  EXPECT_GT(*result.contrast, options_.min_contrast);
  EXPECT_EQ(result.status, ClosureStatus::accepted) << result.reason;
  EXPECT_LT(result.T_query_reference.translation.norm(), 0.05);
  for (const double shift : {-20.0, 20.0}) {
    const ClosureVerification wrong =
        verify_closure(target, query, reference, shifted(shift, 0, 0), options_, registration_);
    EXPECT_NE(wrong.status, ClosureStatus::accepted) << shift;
  }
}

TEST_F(Verification, RejectsAnotherStreetOfTheSameKind) {
  for (const std::uint32_t seed : {2U, 3U, 4U, 5U}) {
    const ClosureVerification result = verify_closure(
        target_, query_, StreetScene(seed).sample(60000, 0.02, 2), Pose(), options_, registration_);
    EXPECT_NE(result.status, ClosureStatus::accepted)
        << "overlap " << result.overlap << " agreement " << result.agreement;
    EXPECT_FALSE(result.reason.empty());
  }
}

TEST_F(Verification, RejectsAPlaceSideways) {
  for (const double shift : {-20.0, -10.0, 10.0, 20.0}) {
    const ClosureVerification result =
        verify_closure(target_, query_, street_.sample(60000, 0.02, 2), shifted(shift, 0, 0),
                       options_, registration_);
    EXPECT_TRUE(result.status != ClosureStatus::accepted ||
                result.T_query_reference.translation.norm() < 0.1)
        << shift;
  }
}

TEST_F(Verification, ByContrastStillRejectsOtherStreetsAndPlacesSideways) {
  options_.between_sessions = true;
  for (const std::uint32_t seed : {2U, 3U, 4U, 5U, 6U, 7U}) {
    const ClosureVerification result = verify_closure(
        target_, query_, StreetScene(seed).sample(60000, 0.02, 2), Pose(), options_, registration_);
    EXPECT_NE(result.status, ClosureStatus::accepted)
        << "agreement " << result.agreement << " contrast " << result.contrast.value_or(-1.0);
  }
  for (const double shift : {-20.0, -10.0, 10.0, 20.0}) {
    const ClosureVerification result =
        verify_closure(target_, query_, street_.sample(60000, 0.02, 2), shifted(shift, 0, 0),
                       options_, registration_);
    EXPECT_TRUE(result.status != ClosureStatus::accepted ||
                result.T_query_reference.translation.norm() < 0.1)
        << shift;
  }
}

TEST_F(Verification, TellsDivergence) {
  const ClosureVerification result =
      verify_closure(target_, query_, {}, Pose(), options_, registration_);
  EXPECT_EQ(result.status, ClosureStatus::icp_diverged);
  EXPECT_STREQ(to_string(result.status), "icp_diverged");
}

}  // namespace
}  // namespace groundloop
