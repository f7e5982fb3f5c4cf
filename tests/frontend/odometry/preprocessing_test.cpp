#include "frontend/odometry/preprocessing.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

SensorMotion forward(double speed) {
  SensorMotion motion;
  motion.velocity[0] = speed;
  return motion;
}

// A point measured at 0.1 s by a sensor that drives 10 m/s lies a metre farther from where it
// started.
TEST(DeskewAndCrop, MovesPointsToTheReferenceTime) {
  Scan scan;
  scan.points = {{5, 0, 0}, {5, 1, 0}, {500, 0, 0}};
  scan.times = {0.0F, 0.1F, 0.1F};
  const Points points = deskew_and_crop(scan, forward(10), 0.0, 1.0, 100.0);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0] - Eigen::Vector3f(5, 0, 0)).norm(), 1e-5F);
  EXPECT_LT((points[1] - Eigen::Vector3f(6, 1, 0)).norm(), 1e-5F);
}

// Times that differ by next to nothing: dividing by their span gave points that were no numbers.
TEST(DeskewAndCrop, TimesThatHardlyDifferMoveNothing) {
  Scan scan;
  scan.points = {{5, 0, 0}, {5, 1, 0}};
  scan.times = {0.0F, std::numeric_limits<float>::denorm_min()};
  EXPECT_EQ(deskew_and_crop(scan, forward(10), 0.0, 1.0, 100.0), scan.points);
}

}  // namespace
}  // namespace groundloop
