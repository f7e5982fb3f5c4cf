#include "backend/evaluation/trajectory_evaluation.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Pose yaw_pose(double x, double y, double z, double yaw) {
  return Pose(exp_so3(Eigen::Vector3d(0.0, 0.0, yaw)), Eigen::Vector3d(x, y, z));
}

// A bent way that is neither straight nor flat.
Trajectory winding(std::size_t n, double step) {
  Trajectory trajectory;
  Pose pose;
  for (std::size_t i = 0; i < n; ++i) {
    trajectory.push_back({static_cast<Nanoseconds>(i) * 100'000'000, pose});
    const double s = static_cast<double>(i);
    Vector6d twist;
    twist << step, 0.0, 0.1 * step * std::sin(0.05 * s), 0.0, 0.01 * std::cos(0.1 * s),
        0.05 * std::sin(0.02 * s);
    pose = pose * exp_se3(twist);
  }
  return trajectory;
}

Trajectory moved(Trajectory trajectory, const Pose& T, double scale = 1.0) {
  for (StampedPose& s : trajectory) {
    s.pose = T * s.pose;
    s.pose.translation *= scale;
  }
  return trajectory;
}

Trajectory kitti(const std::string& name) {
  Trajectory trajectory;
  for (const Pose& pose :
       read_kitti_poses(std::string(GROUNDLOOP_SHARED_DATA) + "/trajectories/" + name)) {
    trajectory.push_back({0, pose});
  }
  return trajectory;
}

TEST(TrajectoryEvaluation, GivesThePublishedErrorsOfKitti00) {
  if (!std::filesystem::exists(std::string(GROUNDLOOP_SHARED_DATA) + "/trajectories")) {
    GTEST_SKIP() << "needs " GROUNDLOOP_SHARED_DATA "/trajectories";
  }
  TrajectoryEvaluationOptions options;
  options.by_row = true;
  const Trajectory truth = kitti("KITTI_00_gt.txt");
  const TrajectoryEvaluation whole = evaluate_trajectory(kitti("KITTI_00_ORB.txt"), truth, options);
  // As the ORB-SLAM2 paper prints them for sequence 00 (Mur-Artal and Tardos, 2017, Table I).
  EXPECT_NEAR(whole.kitti_translation_percent, 0.70, 0.005);
  EXPECT_NEAR(whole.kitti_rotation_deg_per_m * 100.0, 0.25, 0.005);
  const Statistics orb = whole.ape.translation_m;
  EXPECT_NEAR(orb.rmse, 1.3034497145650266, 1e-9);
  EXPECT_NEAR(orb.mean, 1.1569971285389768, 1e-9);
  EXPECT_NEAR(orb.max, 3.587949120678954, 1e-9);
  const Statistics sptam =
      evaluate_trajectory(kitti("KITTI_00_SPTAM.txt"), truth, options).ape.translation_m;
  EXPECT_NEAR(sptam.rmse, 3.738487907582613, 1e-9);
  EXPECT_NEAR(sptam.mean, 3.4909766330848684, 1e-9);
  EXPECT_NEAR(sptam.max, 7.7689774065713175, 1e-9);
}

TEST(TrajectoryEvaluation, UmeyamaFindsAKnownSimilarity) {
  const Trajectory truth = winding(300, 1.0);
  Vector6d xi;
  xi << 10.0, -20.0, 3.0, 0.3, -0.2, 2.0;
  const Pose T = exp_se3(xi);
  std::vector<Pose> a;
  std::vector<Pose> b;
  for (const StampedPose& s : truth) {
    a.push_back(s.pose);
    b.push_back(T * s.pose);
    b.back().translation = T * Eigen::Vector3d(2.5 * s.pose.translation);
  }
  const Alignment found = align_umeyama(a, b, true);
  EXPECT_NEAR(found.scale, 2.5, 1e-12);
  EXPECT_LT((found.pose.translation - T.translation).norm(), 1e-9);
  EXPECT_LT(rotation_angle(found.pose.rotation.conjugate() * T.rotation), 1e-9);
}

TEST(TrajectoryEvaluation, NeverAlignsByAReflection) {
  const Trajectory truth = winding(100, 1.0);
  Trajectory mirrored = truth;
  for (StampedPose& s : mirrored) s.pose.translation.y() *= -1.0;
  const TrajectoryEvaluation result = evaluate_trajectory(mirrored, truth);
  EXPECT_NEAR(result.alignment.pose.rotation_matrix().determinant(), 1.0, 1e-12);
  EXPECT_GT(result.ape.translation_m.rmse, 1e-3);
}

TEST(TrajectoryEvaluation, AlignmentsRemoveWhatTheySayAndNoMore) {
  const Trajectory truth = winding(200, 1.0);
  Vector6d xi;
  xi << 5.0, 6.0, 7.0, 0.1, 0.2, 0.3;
  const Trajectory estimate = moved(truth, exp_se3(xi));
  TrajectoryEvaluationOptions options;
  for (const char* kind : {"origin", "se3", "sim3"}) {
    options.alignment = kind;
    const TrajectoryEvaluation result = evaluate_trajectory(estimate, truth, options);
    EXPECT_LT(result.ape.translation_m.max, 1e-9) << kind;
    EXPECT_LT(result.ape.rotation_deg.max, 1e-5) << kind;
  }
  options.alignment = "none";
  const TrajectoryEvaluation result = evaluate_trajectory(estimate, truth, options);
  EXPECT_NEAR(result.ape.rotation_deg.min, Eigen::Vector3d(0.1, 0.2, 0.3).norm() / kDegree, 1e-9);
  EXPECT_NEAR(result.translation_errors.front().norm(), exp_se3(xi).translation.norm(), 1e-9);

  options.alignment = "sim3";
  EXPECT_NEAR(evaluate_trajectory(moved(truth, Pose(), 0.5), truth, options).alignment.scale, 2.0,
              1e-12);
  EXPECT_LT(
      evaluate_trajectory(moved(truth, Pose(), 0.5), truth, options).rpe_frame.translation_m.max,
      1e-9);
}

TEST(TrajectoryEvaluation, StatisticsOfAKnownSet) {
  const Statistics s = statistics({4.0, 1.0, 2.0, 9.0});
  EXPECT_DOUBLE_EQ(s.mean, 4.0);
  EXPECT_DOUBLE_EQ(s.median, 3.0);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(102.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt((0.0 + 9.0 + 4.0 + 25.0) / 4.0));
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.max, 9.0);
}

TEST(TrajectoryEvaluation, SplitsTheErrorAlongTheAxesOfTheGroundTruth) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 10; ++i) {
    truth.push_back({i, yaw_pose(i, 0, 0, 0)});
    estimate.push_back({i, yaw_pose(i + 0.1, -0.2, 0.4, 3.0 * kDegree)});
  }
  TrajectoryEvaluationOptions options;
  options.alignment = "none";
  const TrajectoryEvaluation result = evaluate_trajectory(estimate, truth, options);
  EXPECT_NEAR(result.ape_x_m.rmse, 0.1, 1e-12);
  EXPECT_NEAR(result.ape_y_m.rmse, 0.2, 1e-12);
  EXPECT_NEAR(result.ape_z_m.rmse, 0.4, 1e-12);
  EXPECT_NEAR(result.ape.rotation_deg.mean, 3.0, 1e-9);
}

TEST(TrajectoryEvaluation, RelativeErrorsOfAKnownDrift) {
  // Steps of 1 m that the estimate makes 1.02 m long, on a straight line.
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 1000; ++i) {
    truth.push_back({i, yaw_pose(i, 0, 0, 0)});
    estimate.push_back({i, yaw_pose(1.02 * i, 0, 0, 0)});
  }
  const TrajectoryEvaluation result = evaluate_trajectory(estimate, truth);
  EXPECT_NEAR(result.rpe_frame.translation_m.mean, 0.02, 1e-9);
  EXPECT_EQ(result.rpe_frame.count, 999U);
  EXPECT_NEAR(result.rpe_distance.translation_m.mean, 0.2, 1e-9);
  EXPECT_EQ(result.rpe_distance.count, 990U);
  // The kit takes the first pose beyond 100 m, which is 101 m on, and divides by 100.
  double percent = 0.0;
  int segments = 0;
  for (int first = 0; first < 1000; first += 10) {
    for (int length = 100; length <= 800; length += 100) {
      if (first + length + 1 >= 1000) continue;
      percent += 100.0 * 0.02 * (length + 1) / length;
      ++segments;
    }
  }
  EXPECT_EQ(result.kitti_segments, static_cast<std::size_t>(segments));
  EXPECT_NEAR(result.kitti_translation_percent, percent / segments, 1e-9);
  EXPECT_NEAR(result.kitti_rotation_deg_per_m, 0.0, 1e-9);
}

TEST(TrajectoryEvaluation, KittiRotationErrorPerMetre) {
  // The estimate turns 0.001 degrees a metre more than the truth, which drives straight on.
  Trajectory truth;
  Trajectory estimate;
  Pose pose;
  for (int i = 0; i < 400; ++i) {
    truth.push_back({i, yaw_pose(i, 0, 0, 0)});
    estimate.push_back({i, pose});
    pose = pose * yaw_pose(1.0, 0, 0, 0.001 * kDegree);
  }
  EXPECT_NEAR(evaluate_trajectory(estimate, truth).kitti_rotation_deg_per_m, 0.001, 1e-5);
}

TEST(TrajectoryEvaluation, PairsTheNearestStampsWithinTheTolerance) {
  const auto at = [](double seconds) {
    return StampedPose{static_cast<Nanoseconds>(std::llround(seconds * 1e9)), Pose()};
  };
  const Trajectory estimate{at(1.000), at(2.004), at(3.02), at(4.000)};
  const Trajectory truth{at(0.5), at(1.009), at(1.999), at(2.003), at(3.0), at(4.0), at(5.0)};
  const auto pairs = associate(estimate, truth, 0.01);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0], std::make_pair(std::size_t{0}, std::size_t{1}));
  EXPECT_EQ(pairs[1], std::make_pair(std::size_t{1}, std::size_t{3}));
  EXPECT_EQ(pairs[2], std::make_pair(std::size_t{3}, std::size_t{5}));
  const auto reversed = associate(truth, estimate, 0.01);
  ASSERT_EQ(reversed.size(), 3U);
  EXPECT_EQ(reversed[1], std::make_pair(std::size_t{3}, std::size_t{1}));
}

TEST(TrajectoryEvaluation, UsesAPoseOnceAndForItsNearestPartner) {
  const Trajectory estimate{{1'000'000, Pose()}, {3'000'000, Pose()}};
  const Trajectory truth{{2'900'000, Pose()}, {900'000'000, Pose()}};
  const auto pairs = associate(estimate, truth, 0.01);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].first, 1U);
}

TEST(TrajectoryEvaluation, AStraightWayIsAlignedWithTheHelpOfItsOrientations) {
  Trajectory truth;
  for (int i = 0; i < 50; ++i) truth.push_back({i, yaw_pose(i, 0, 0, 0)});
  Vector6d xi;
  xi << 1.0, 2.0, 3.0, 0.5, 0.1, 1.0;
  const TrajectoryEvaluation result = evaluate_trajectory(moved(truth, exp_se3(xi)), truth);
  EXPECT_LT(result.ape.translation_m.max, 1e-6);
  EXPECT_LT(result.ape.rotation_deg.max, 1e-3);
}

TEST(TrajectoryEvaluation, ASinglePairIsDefined) {
  const TrajectoryEvaluation result =
      evaluate_trajectory({{0, yaw_pose(1, 2, 3, 1)}}, {{0, yaw_pose(0, 0, 0, 0)}});
  EXPECT_NEAR(result.ape.translation_m.max, 0.0, 1e-12);
  EXPECT_NEAR(result.ape.rotation_deg.max, 0.0, 1e-6);
  EXPECT_EQ(result.rpe_frame.count, 0U);
  EXPECT_EQ(result.kitti_segments, 0U);
}

TEST(TrajectoryEvaluation, RefusesWhatCannotBePaired) {
  const Trajectory a{{0, Pose()}, {1'000'000'000, Pose()}};
  const Trajectory b{{500'000'000, Pose()}};
  EXPECT_THROW((void)evaluate_trajectory(a, b), InputError);
  TrajectoryEvaluationOptions options;
  options.by_row = true;
  EXPECT_THROW((void)evaluate_trajectory(a, b, options), InputError);
  options.alignment = "umeyama";
  EXPECT_THROW((void)evaluate_trajectory(a, a, options), InputError);
}

}  // namespace
}  // namespace groundloop
