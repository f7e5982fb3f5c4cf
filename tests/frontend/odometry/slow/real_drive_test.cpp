// The real drive, opened as a user would.
#include "tests/support/real_drive.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/recordings/recording.hpp"

namespace groundloop {
namespace {

TEST(RealDrive, OpensByItsRootWithElevationCorrected) {
  const auto root = testing::real_drive();
  if (root.empty()) GTEST_SKIP() << "the real drive is absent from " GROUNDLOOP_SHARED_DATA;
  const auto corrected = open_recording(root.string());
  EXPECT_EQ(corrected->size(), 1905U);
  EXPECT_EQ(corrected->ground_truth().size(), 1905U);
  EXPECT_THAT(corrected->info().notes.back(), ::testing::HasSubstr("corrected by +0.205"));
  RecordingOptions options;
  options.elevation_correction = "off";
  const Scan raw = open_recording(root.string(), options)->read(100);
  const Scan raised = corrected->read(100);
  ASSERT_EQ(raw.points.size(), raised.points.size());
  // 0.205 degrees are 3.58 mm a metre.
  const double distance = raw.points[0].head<2>().norm();
  EXPECT_NEAR(raised.points[0].z() - raw.points[0].z(), 3.578e-3 * distance, 1e-3 * distance / 10);
}

}  // namespace
}  // namespace groundloop
