#include "backend/evaluation/visit_distance.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

Pairs all_pairs(std::size_t n) {
  Pairs pairs;
  for (std::size_t i = 0; i < n; ++i) pairs.emplace_back(i, i);
  return pairs;
}

// Twice around a circle of `way` metres, 0.55 m and `step_s` seconds a step: two are a stop.
Trajectory two_rounds(double way, double step_s) {
  Trajectory trajectory;
  const double radius = way / (2.0 * M_PI);
  const int steps = static_cast<int>(std::lround(2.0 * way / 0.55));
  for (int i = 0; i < steps; ++i) {
    const double angle = 0.55 * i / radius;
    trajectory.push_back(
        {static_cast<Nanoseconds>(i * step_s * 1e9),
         Pose(exp_so3({0, 0, angle}), {radius * std::cos(angle), radius * std::sin(angle), 0.0})});
  }
  return trajectory;
}

TEST(VisitDistance, IsTheOffsetOfTheSecondVisit) {
  // The second round lies 0.3 m above the first in the estimate, in a frame of its own.
  const Trajectory truth = two_rounds(200.0, 0.03);
  const Pose T_estimate_truth(exp_so3({0.3, -0.2, 1.0}), {40, -7, 3});
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    Pose pose = truth[i].pose;
    if (i >= truth.size() / 2) pose.translation.z() += 0.3;
    estimate[i].pose = T_estimate_truth * pose;
  }
  const VisitDistances found = visit_distances(estimate, truth, all_pairs(truth.size()));
  // Each of the 182 stops of the first round meets those of the second within 5 m to either side.
  EXPECT_NEAR(static_cast<double>(found.by_way.pairs), 182 * 10 / 1.1, 60);
  EXPECT_NEAR(found.by_way.median_m, 0.3, 1e-9);
  EXPECT_NEAR(found.by_way.most_m, 0.3, 1e-9);
  EXPECT_EQ(found.by_time.pairs, 0U) << "both rounds take 22 s";
  const VisitDistances same = visit_distances(truth, truth, all_pairs(truth.size()));
  EXPECT_LT(same.by_way.most_m, 1e-9);
}

TEST(VisitDistance, LooksAtTimeWhereRoundsAreShort) {
  const Trajectory truth = two_rounds(40.0, 0.5);  // a round takes 40 s
  Trajectory estimate = truth;
  for (std::size_t i = truth.size() / 2; i < truth.size(); ++i)
    estimate[i].pose.translation.x() += 0.2;
  const VisitDistances found = visit_distances(estimate, truth, all_pairs(truth.size()));
  EXPECT_EQ(found.by_way.pairs, 0U);
  EXPECT_GT(found.by_time.pairs, 100U);
  EXPECT_NEAR(found.by_time.median_m, 0.2, 1e-9);
}

TEST(VisitDistance, NobodyWhoStandsStillVisitsAnything) {
  Trajectory truth;
  for (int i = 0; i < 1000; ++i) truth.push_back({i * 1'000'000'000LL, Pose()});
  const VisitDistances found = visit_distances(truth, truth, all_pairs(truth.size()));
  EXPECT_EQ(found.by_way.pairs, 0U);
  EXPECT_EQ(found.by_time.pairs, 0U);
  EXPECT_EQ(visit_distances({}, {}, {}).by_way.pairs, 0U);
}

TEST(VisitDistance, CountsARotationByItsLever) {
  // Scans 4 m apart; the second is turned by 0.01 rad: T_estimate^-1 T_truth moves nothing at the
  // scan that is turned, and 4 m times 0.01 at the other.
  Trajectory truth = two_rounds(200.0, 0.03);
  Trajectory estimate = truth;
  VisitDistanceOptions options;
  options.spacing = 0.0;
  options.way = 0.0;
  const Pairs two{{0, 0}, {8, 8}};
  estimate[0].pose.rotation = truth[0].pose.rotation * exp_so3({0, 0, 0.01});
  const VisitDistances found = visit_distances(estimate, truth, two, options);
  const double apart = (truth[0].pose.translation - truth[8].pose.translation).norm();
  ASSERT_EQ(found.by_way.pairs, 1U);
  EXPECT_NEAR(found.by_way.median_m, 2.0 * std::sin(0.005) * apart, 1e-9);
}

}  // namespace
}  // namespace groundloop
