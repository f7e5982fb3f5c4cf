#include "backend/closure_anchor.hpp"

#include <gtest/gtest.h>

namespace groundloop {
namespace {

// Along x from 0 to 99 m, and back beside it; odometry of the way back turns by `turn` rad/m.
struct ThereAndBack {
  Trajectory truth, odometry;
  LocalMapRecord reference{0, 0, 99, 0, {}}, query{1, 100, 199, 0, {}};

  explicit ThereAndBack(double turn) {
    for (int i = 0; i < 100; ++i)
      truth.push_back({100000000LL * i, Pose(Eigen::Quaterniond::Identity(), {1.0 * i, 0, 0})});
    for (int i = 0; i < 100; ++i) {
      // It leaves the first road after 50 m.
      truth.push_back({100000000LL * (100 + i),
                       Pose(exp_so3({0, 0, M_PI}), {99.0 - i, i < 50 ? 4.0 : 4.0 + i - 50, 0})});
    }
    odometry = truth;
    Pose bent = truth[100].pose;
    for (std::size_t i = 101; i < 200; ++i) {
      bent = bent * (truth[i - 1].pose.inverse() * truth[i].pose) *
             Pose(exp_so3({0, turn, 0}), Eigen::Vector3d::Zero());
      odometry[i].pose = bent;
    }
  }
  [[nodiscard]] Pose between(const Trajectory& t, std::size_t from, std::size_t to) const {
    return t[from].pose.inverse() * t[to].pose;
  }
};

TEST(ClosureAnchor, StandsWhereTheWaysRunBesideEachOther) {
  const ThereAndBack ways(0.0);
  const ClosureAnchor anchor = anchor_closure(ways.between(ways.truth, 100, 0), ways.reference,
                                              ways.truth, ways.query, ways.truth);
  // The first road is shared from 50 to 99 m, and within 14 m from 41 m on.
  EXPECT_NEAR(static_cast<double>(anchor.reference_scan), 70, 4);
  EXPECT_NEAR(static_cast<double>(anchor.query_scan), 100 + 99 - 70, 4);
  const Pose expected = ways.between(ways.truth, anchor.query_scan, anchor.reference_scan);
  EXPECT_LT(log_se3(anchor.T_query_reference.inverse() * expected).norm(), 1e-9);
}

TEST(ClosureAnchor, CarriedBackAlongTheSameOdometryIsWhatItWas) {
  const ThereAndBack ways(1e-3);
  Vector6d twist;
  twist << 80, 3, -1, 0.02, -0.01, 3.0;
  const Pose T = exp_se3(twist);
  const ClosureAnchor anchor =
      anchor_closure(T, ways.reference, ways.odometry, ways.query, ways.odometry);
  const Pose back =
      carried_to_origins(anchor, ways.reference, ways.odometry, ways.query, ways.odometry);
  EXPECT_LT(log_se3(back.inverse() * T).norm(), 1e-9);
}

TEST(ClosureAnchor, LosesTheErrorOfTheWayWhenCarriedAlongTheTruth) {
  const ThereAndBack ways(1e-3);
  // Registration found how the bent map lies on the straight one, at the scans 130 and 69.
  const Pose measured = ways.between(ways.odometry, 100, 130) * ways.between(ways.truth, 130, 69) *
                        ways.between(ways.truth, 69, 0);
  const Pose expected = ways.between(ways.truth, 100, 0);
  const Pose error = expected.inverse() * measured;
  const ClosureAnchor anchor =
      anchor_closure(measured, ways.reference, ways.odometry, ways.query, ways.odometry);
  const Pose carried =
      carried_to_origins(anchor, ways.reference, ways.truth, ways.query, ways.truth);
  const Pose left = expected.inverse() * carried;
  EXPECT_GT(error.translation.norm(), 1.0);
  EXPECT_LT(left.translation.norm(), 0.1 * error.translation.norm());
}

}  // namespace
}  // namespace groundloop
