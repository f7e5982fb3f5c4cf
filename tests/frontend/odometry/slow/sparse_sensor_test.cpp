// Odometry of a sensor of 16 beams in a street without any error of the sensor: what is left is the
// odometry's own. Scan lines registered to scan lines tilted it by 38 millidegrees a metre here.
#include <cmath>

#include <gtest/gtest.h>

#include "frontend/odometry/odometry.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop {
namespace {

TEST(SparseSensor, SixteenBeamsDoNotTiltTheWay) {
  const auto recording = open_any_recording("sim:town?sensor=spin16&length=150&seed=5&noise=0", {});
  const Trajectory truth = recording->ground_truth();
  Odometry odometry{OdometryOptions{}};
  odometry.start(recording->read(0), recording->read(1));
  Pose last;
  for (std::size_t i = 0; i < recording->size(); ++i)
    last = odometry.add(recording->read(i), "scan").T_world_scan;
  const Pose expected = truth.front().pose.inverse() * truth.back().pose;
  const Pose error = expected.inverse() * last;
  EXPECT_LT(rotation_angle(error.rotation), 1.5 * M_PI / 180.0);
  EXPECT_LT(error.translation.norm(), 0.01 * 150.0);
}

}  // namespace
}  // namespace groundloop
