#include "backend/mapping/closure_anchor.hpp"

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

// On straight ways along x, both origins a way of n steps of 1 m from the meeting: a position is
// lost by n steps along x on each way, and a heading by n steps, which displaces the other origin
// by the rest of the way at every step (and along x by the 4 m between the ways, on one of them).
TEST(ClosureAnchor, AtTheOriginsKnowsLessByTheWays) {
  LocalMapRecord reference{0, 0, 40, 0, {}}, query{1, 41, 81, 0, {}};
  Trajectory ways;
  for (int map = 0; map < 2; ++map) {
    for (int i = 0; i <= 40; ++i)
      ways.push_back({0, Pose(Eigen::Quaterniond::Identity(), {1.0 * i, 4.0 * map, 0.0})});
  }
  OdometryInformationOptions drift;
  drift.translation_floor = drift.rotation_floor = 1e-9;
  const int n = 10;
  const ClosureAnchor anchor{41 + n, n, ways[41 + n].pose.inverse() * ways[n].pose};
  const Matrix6d known = 1e8 * Matrix6d::Identity();
  const Matrix6d covariance =
      information_between_origins(anchor, known, reference, ways, query, ways, drift).inverse();
  const double step = drift.translation * drift.translation, turn = drift.rotation * drift.rotation;
  EXPECT_NEAR(covariance(0, 0), 2 * n * step + n * turn * 16.0, 0.2 * step);
  EXPECT_NEAR(covariance(5, 5), 2 * n * turn, 1e-2 * turn + 2e-8);
  // A turn k m from the origin moves it sideways by k: twice the sum of k^2.
  double sideways = 2 * n * step;
  for (int k = 1; k <= n; ++k) sideways += 2 * turn * k * k;
  EXPECT_NEAR(covariance(1, 1), sideways, 0.02 * sideways);
  // A direction that nothing holds stays free.
  Matrix6d free = known;
  free.row(0).setZero();
  free.col(0).setZero();
  const Matrix6d kept =
      information_between_origins(anchor, free, reference, ways, query, ways, drift);
  EXPECT_NEAR(kept(0, 0), 0.0, 1e-9);
}

}  // namespace
}  // namespace groundloop
