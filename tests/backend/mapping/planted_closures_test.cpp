#include "tests/support/planted_closures.hpp"

#include <gtest/gtest.h>

namespace groundloop::testing {
namespace {

// Twenty maps of one scan each, 100 m apart, and one closure of truth.
struct Session {
  Session() {
    for (int i = 0; i < 20; ++i) {
      StampedPose pose;
      pose.pose.translation.x() = 100.0 * i;
      odometry.push_back(pose);
      LocalMapRecord map;
      map.map = i;
      map.first_scan = map.last_scan = static_cast<std::size_t>(i);
      maps.push_back(map);
    }
    ClosureRecord closure;
    closure.reference_map = 2;
    closure.query_map = 15;
    closure.status = ClosureStatus::accepted;
    closure.T_query_reference.translation.y() = 7.0;
    closures.push_back(closure);
  }
  Trajectory odometry;
  std::vector<LocalMapRecord> maps;
  std::vector<ClosureRecord> closures;
};

TEST(PlantedClosures, AreNoneByDefault) {
  Session session;
  plant_false_closures({}, session.odometry, session.maps, session.closures);
  EXPECT_EQ(session.closures.size(), 1u);
}

TEST(PlantedClosures, NearOnesAreFiveToTwentyMetresFromAnAcceptedOne) {
  Session session;
  PlantedClosures options;
  options.near = 30;
  plant_false_closures(options, session.odometry, session.maps, session.closures);
  ASSERT_EQ(session.closures.size(), 31u);
  for (std::size_t i = 1; i < session.closures.size(); ++i) {
    const ClosureRecord& c = session.closures[i];
    EXPECT_EQ(c.status, ClosureStatus::accepted);
    EXPECT_EQ(c.query_map, 15);
    const Pose off = session.closures[0].T_query_reference.inverse() * c.T_query_reference;
    EXPECT_GE(off.translation.norm(), 5.0);
    EXPECT_LE(off.translation.norm(), 20.0);
  }
}

TEST(PlantedClosures, AGroupAgreesOverOdometry) {
  Session session;
  PlantedClosures options;
  options.groups = 1;
  plant_false_closures(options, session.odometry, session.maps, session.closures);
  ASSERT_EQ(session.closures.size(), 5u);
  const auto T_world_map = [&](int map) { return session.odometry[map].pose; };
  const auto claim = [&](const ClosureRecord& c) {
    // What the closure says about where the reference's stretch lies, seen from the query's.
    return T_world_map(c.query_map) * c.T_query_reference * T_world_map(c.reference_map).inverse();
  };
  for (std::size_t i = 2; i < 5; ++i) {
    EXPECT_GE(session.closures[i].query_map - session.closures[i].reference_map, 4);
    const Pose apart = claim(session.closures[1]).inverse() * claim(session.closures[i]);
    EXPECT_LT(apart.translation.norm() + rotation_angle(apart.rotation), 1e-9);
  }
}

TEST(PlantedClosures, AreTheSameEachTime) {
  PlantedClosures options;
  options.random = 5;
  Session a, b;
  plant_false_closures(options, a.odometry, a.maps, a.closures);
  plant_false_closures(options, b.odometry, b.maps, b.closures);
  ASSERT_EQ(a.closures.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(closure_row(a.closures[i]), closure_row(b.closures[i]));
}

}  // namespace
}  // namespace groundloop::testing
