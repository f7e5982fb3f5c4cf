// Frames of ground truth against ways whose frame is known.
#include "backend/evaluation/truth_frame.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace groundloop {
namespace {

using testing::camera_lidar;
using testing::Ways;
using testing::ways;

constexpr double kDegree = M_PI / 180.0;

std::vector<FrameCandidate> sensor_only() { return {{"sensor", Pose()}}; }

TEST(TruthFrame, TheSensorsOwnStands) {
  for (const double drift : {0.0, 1.0, 3.0}) {
    const Ways w = ways(Pose(), drift, false);
    const TruthFrame frame = judge_truth_frame(w.estimate, w.truth, sensor_only());
    EXPECT_EQ(frame.name, "sensor");
    EXPECT_FALSE(frame.found);
    EXPECT_TRUE(frame.fits && frame.told);
  }
}

TEST(TruthFrame, ACalibrationBesideItIsPreferredToWhatTheMotionSays) {
  const Ways w = ways(camera_lidar(), 1.0, false);
  std::vector<FrameCandidate> candidates = sensor_only();
  candidates.push_back({"camera", camera_lidar()});
  const TruthFrame frame = judge_truth_frame(w.estimate, w.truth, candidates);
  EXPECT_EQ(frame.name, "camera");
  EXPECT_TRUE(frame.fits);
  // And one that does not apply is left aside.
  const Ways own = ways(Pose(), 1.0, false);
  EXPECT_EQ(judge_truth_frame(own.estimate, own.truth, {candidates[1], candidates[0]}).name,
            "sensor");
}

TEST(TruthFrame, IsFoundExactlyWhereOdometryIsExact) {
  const Pose X(exp_so3({0.4, -1.1, 2.0}), Eigen::Vector3d(0.7, -0.4, 0.5));
  const Ways w = ways(X, 0.0, false);
  const TruthFrame frame = judge_truth_frame(w.estimate, w.truth, sensor_only());
  EXPECT_TRUE(frame.found);
  const Pose error = X.inverse() * frame.T_truth_sensor;
  EXPECT_LT(rotation_angle(error.rotation), 0.1 * kDegree);
  EXPECT_LT(error.translation.norm(), 0.02);
}

TEST(TruthFrame, IsFoundOnAFlatWayWithinWhatItSays) {
  const Ways w = ways(camera_lidar(), 1.0, true, 5);
  const TruthFrame frame = judge_truth_frame(w.estimate, w.truth, sensor_only());
  EXPECT_TRUE(frame.found);
  const Pose error = camera_lidar().inverse() * frame.T_truth_sensor;
  EXPECT_LT(rotation_angle(error.rotation) / kDegree, 1.0);
  EXPECT_LT(rotation_angle(error.rotation) / kDegree, 4.0 * frame.rotation_deviation_deg + 0.1);
  // Height is not to be seen on a flat way; where in the plane the camera sits is.
  EXPECT_LT(std::abs(error.translation.x()), 0.3);
  EXPECT_LT(frame.disagreement_deg, 1.0);
}

TEST(TruthFrame, ALeverArmAloneIsFound) {
  const Pose X(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1.5, 0.6, 0.0));
  const Ways w = ways(X, 0.1, true);
  const TruthFrame frame = judge_truth_frame(w.estimate, w.truth, sensor_only());
  EXPECT_TRUE(frame.found);
  EXPECT_LT((frame.T_truth_sensor.translation - X.translation).head<2>().norm(), 0.1);
}

TEST(TruthFrame, AnotherRecordingsTruthFitsNowhere) {
  const Ways a = ways(Pose(), 1.0, false);
  Ways b = ways(Pose(), 1.0, false, 2);
  std::reverse(b.truth.begin(), b.truth.end());
  for (std::size_t i = 0; i < b.truth.size(); ++i) b.truth[i] = b.truth[(i * 37) % b.truth.size()];
  EXPECT_FALSE(judge_truth_frame(a.estimate, b.truth, sensor_only()).fits);
}

TEST(TruthFrame, AWayThatIsTooShortTellsNothing) {
  const Ways w = ways(camera_lidar(), 1.0, false);
  const std::vector<Pose> few(w.estimate.begin(), w.estimate.begin() + 3);
  const std::vector<Pose> few_truths(w.truth.begin(), w.truth.begin() + 3);
  const TruthFrame frame = judge_truth_frame(few, few_truths, sensor_only());
  EXPECT_FALSE(frame.told);
  EXPECT_EQ(frame.name, "sensor");
}

// A car that speeds up, brakes and turns; truth stamped at an instant of the scan.
Trajectory drive(double shift, int milliseconds) {
  Trajectory trajectory;
  Pose pose;
  for (int i = 0; i < 60'000; ++i) {
    const double t = 0.001 * i;
    if (i % milliseconds == 0)
      trajectory.push_back({static_cast<Nanoseconds>(std::llround((t - shift) * 1e9)), pose});
    Vector6d twist = Vector6d::Zero();
    twist[0] = 6.0 + 5.0 * std::sin(0.7 * t);
    twist[5] = 0.4 * std::sin(0.9 * t);
    pose = pose * exp_se3(twist * 0.001);
  }
  return trajectory;
}

TEST(TruthInstant, IsToldWhereTheMotionChanges) {
  const Trajectory truth = drive(0.0, 10);
  for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    const Trajectory estimate = drive(share * 0.1, 100);
    EXPECT_NEAR(judge_truth_instant(estimate, truth, 0.1), share * 0.1, 1e-9) << share;
  }
}

}  // namespace
}  // namespace groundloop
