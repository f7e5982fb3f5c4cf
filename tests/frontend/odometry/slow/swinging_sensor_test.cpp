#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "frontend/odometry/odometry.hpp"
#include "frontend/simulation/simulation.hpp"

namespace groundloop {
namespace {

struct StepErrors {
  double rotation_deg = 0.0, translation = 0.0;  // rms from scan to scan
};

// Of odometry over 80 scans, from the tenth on, against the simulation's truth.
StepErrors step_errors(const std::string& specification) {
  const auto recording = open_simulation(specification);
  const Trajectory truth = recording->ground_truth();
  Odometry odometry{OdometryOptions{}};
  odometry.start(recording->read(0), recording->read(1));
  StepErrors sum;
  Pose last;
  constexpr std::size_t scans = 80, settled = 10;
  for (std::size_t i = 0; i < scans; ++i) {
    const Pose pose = odometry.add(recording->read(i), "scan").T_world_scan;
    const Pose step = last.inverse() * pose;
    last = pose;
    if (i < settled) continue;
    const Pose error = (truth[i - 1].pose.inverse() * truth[i].pose).inverse() * step;
    const double angle = rotation_angle(error.rotation) * 180.0 / M_PI;
    sum.rotation_deg += angle * angle;
    sum.translation += error.translation.squaredNorm();
  }
  return {std::sqrt(sum.rotation_deg / (scans - settled)),
          std::sqrt(sum.translation / (scans - settled))};
}

// A hand swings by 30 degrees; deskewed by the velocity of the step before, scans erred by 0.5
// degrees and 5 cm.
TEST(SwingingSensor, IsFollowedFromScanToScan) {
  const StepErrors walker = step_errors("sim:town?sensor=spin64&carrier=walker&length=100&seed=7");
  EXPECT_LT(walker.rotation_deg, 0.2);
  EXPECT_LT(walker.translation, 0.03);
}

// Two wheels in a park, where all but the ground is scattered: a swing that the first scans do not
// show is never seen again.
TEST(SwingingSensor, IsFoundOverOpenGround) {
  const StepErrors segway = step_errors("sim:park?sensor=spin32&carrier=segway&length=100&seed=5");
  EXPECT_LT(segway.rotation_deg, 0.2);
  EXPECT_LT(segway.translation, 0.03);
}

}  // namespace
}  // namespace groundloop
