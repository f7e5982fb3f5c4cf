#include "backend/mapping/odometry_trust.hpp"

#include <gmock/gmock.h>

namespace groundloop {
namespace {

using ::testing::HasSubstr;

constexpr auto good = OdometryState::good, weak = OdometryState::weak, lost = OdometryState::lost,
               predicted = OdometryState::predicted;

OdometryTrust trust(const std::vector<OdometryState>& states) {
  std::vector<ScanQuality> scans;
  Trajectory odometry;
  for (const OdometryState state : states) {
    ScanQuality quality;
    quality.state = state;
    quality.doubt = state == lost ? Doubt::jump : Doubt::none;
    odometry.push_back({static_cast<Nanoseconds>(scans.size()) * 500000000, Pose()});
    scans.push_back(quality);
  }
  return trust_of(scans, odometry);
}

TEST(OdometryTrust, GoodOdometrySaysNothing) {
  const OdometryTrust t = trust(std::vector(20, good));
  EXPECT_EQ(t.state, good);
  EXPECT_EQ(t.count(good), 20U);
  EXPECT_TRUE(warning_of(t).empty());
}

TEST(OdometryTrust, SaysFromWhenAndHowMuchIsLost) {
  const OdometryTrust t = trust({good, good, good, lost, predicted, lost, good, good, lost, good});
  EXPECT_EQ(t.state, lost);
  ASSERT_EQ(t.lost.size(), 2U);
  EXPECT_EQ(t.lost[0].first_scan, 3U);
  EXPECT_EQ(t.lost[0].last_scan, 5U);
  EXPECT_EQ(t.lost[0].from_s, 1.5);
  EXPECT_EQ(t.lost[0].to_s, 2.5);
  EXPECT_EQ(t.lost[1].first_scan, 8U);
  EXPECT_THAT(warning_of(t), HasSubstr("LOST from scan 3 on, 1.5 s after the start (jump)"));
  EXPECT_THAT(warning_of(t), HasSubstr("2 times, 3 of 10 scans (30.0 %)"));
}

TEST(OdometryTrust, TheWeakScansThatLedThereAreNotToBeTrustedEither) {
  const OdometryTrust t = trust({good, weak, good, weak, predicted, weak, lost, lost, good});
  ASSERT_EQ(t.lost.size(), 1U);
  EXPECT_EQ(t.lost[0].first_scan, 3U);
  EXPECT_EQ(t.lost[0].last_scan, 7U);
}

// After 10.5 s, of which 10 were predicted, a sensor may be 107 m off.
TEST(OdometryTrust, AStepThatIsNotKnownIsLooseByTheTimeItTook) {
  std::vector<ScanQuality> scans(24);
  Trajectory odometry;
  for (std::size_t i = 0; i < scans.size(); ++i)
    odometry.push_back({static_cast<Nanoseconds>(i) * 500000000, Pose()});
  for (std::size_t i = 2; i < 22; ++i) {
    scans[i].state = predicted;
    scans[i].doubt = Doubt::unseen;
  }
  scans[22].state = lost;
  scans[22].doubt = Doubt::long_gap;
  const std::vector<Vector6d> loose = loose_steps(scans, odometry);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (i != 22) {
      EXPECT_TRUE(loose[i].isZero(0.0)) << i;
    }
  }
  EXPECT_NEAR(loose[22](0), 107.0 * 107.0, 1e-9);
  EXPECT_NEAR(loose[22](5), 1.0, 1e-12);
}

TEST(OdometryTrust, OneWeakScanInTwentyIsSaid) {
  std::vector states(40, good);
  states[7] = weak;
  EXPECT_EQ(trust(states).state, good);
  states[8] = weak;
  EXPECT_EQ(trust(states).state, weak);
  EXPECT_THAT(warning_of(trust(states)), HasSubstr("2 of 40 scans (5.0 %)"));
}

}  // namespace
}  // namespace groundloop
