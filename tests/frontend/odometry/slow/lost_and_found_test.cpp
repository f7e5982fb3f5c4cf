// Odometry says when it does not know where it is, and does not say so where it does: a simulated
// drive as it is, and with ten seconds of it missing.
#include <algorithm>

#include <gtest/gtest.h>

#include "frontend/odometry/odometry.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kMiddle = 60;  // scan from which on something is done to the recording

std::vector<ScanQuality> qualities(const std::vector<Scan>& scans) {
  Odometry odometry{OdometryOptions{}};
  odometry.start(scans[0], scans[1]);
  std::vector<ScanQuality> result;
  for (const Scan& scan : scans) result.push_back(odometry.add(scan, "scan").quality);
  return result;
}

std::vector<Scan> drive() {
  const auto recording = open_any_recording("sim:town?sensor=spin16&length=220&seed=5", {});
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < recording->size(); ++i) scans.push_back(recording->read(i));
  return scans;
}

std::size_t count(const std::vector<ScanQuality>& scans, OdometryState state) {
  return static_cast<std::size_t>(std::count_if(
      scans.begin(), scans.end(), [&](const ScanQuality& q) { return q.state == state; }));
}

TEST(LostAndFound, AnHonestDriveIsGood) {
  const auto scans = qualities(drive());
  EXPECT_EQ(count(scans, OdometryState::lost), 0U);
  EXPECT_LE(count(scans, OdometryState::weak), scans.size() / 100);
}

TEST(LostAndFound, TenSecondsThatAreMissingAreALossAndThenItGoesOn) {
  std::vector<Scan> scans = drive();
  ASSERT_GT(scans.size(), kMiddle + 130);
  scans.erase(scans.begin() + kMiddle, scans.begin() + kMiddle + 100);
  const auto q = qualities(scans);
  EXPECT_EQ(q[kMiddle - 1].state, OdometryState::good);
  EXPECT_EQ(q[kMiddle].state, OdometryState::lost);
  EXPECT_EQ(q[kMiddle].doubt, Doubt::long_gap);
  EXPECT_EQ(q.back().state, OdometryState::good);
}

}  // namespace
}  // namespace groundloop
