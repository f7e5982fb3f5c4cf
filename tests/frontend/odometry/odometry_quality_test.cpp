#include "frontend/odometry/odometry_quality.hpp"

#include <cmath>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

// A registration whose points, all at the sensor, are known to `point_sigma`.
ScanRegistration known_to(double point_sigma) {
  ScanRegistration registration;
  registration.converged = true;
  registration.correspondences = 100;
  registration.inlier_share = 0.5;
  registration.residual = 0.1;
  registration.information =
      Matrix6d::Identity() * 3.0 * std::pow(registration.residual / point_sigma, 2);
  return registration;
}

class Judge {
 public:
  ScanQuality scan(double point_sigma, double jump = 0.0, double step = 0.1, double fit = 1.0) {
    return scan(known_to(point_sigma), jump, step, fit);
  }
  ScanQuality scan(const ScanRegistration& registration, double jump = 0.0, double step = 0.1,
                   double fit = 1.0) {
    const Points points(10, Eigen::Vector3f::Zero());
    constexpr double kWay = 0.5;
    return judge.registered({registration, points, fit, step, kWay, jump, Pose()});
  }
  std::vector<OdometryState> scans(double point_sigma, int count) {
    std::vector<OdometryState> states;
    for (int i = 0; i < count; ++i) states.push_back(scan(point_sigma).state);
    return states;
  }
  OdometryJudge judge{OdometryJudge::Limits{}};
};

constexpr double kGood = 0.02, kUncertain = 0.15, kUnheld = 0.3;  // m; the kernel's scale is 0.2
constexpr auto good = OdometryState::good, weak = OdometryState::weak, lost = OdometryState::lost;

TEST(OdometryQuality, PointsMoveAsTheCovarianceOfTheirPoseSays) {
  Points points;
  for (int i = 0; i < 20; ++i)
    points.emplace_back(std::sin(1.7F * static_cast<float>(i)),
                        3.0F + std::cos(2.3F * static_cast<float>(i)),
                        0.1F * static_cast<float>(i));
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = 0.01 * std::sin(1.0 + i);
  const Matrix6d covariance = root * root.transpose();
  double sum = 0.0;
  for (const Eigen::Vector3f& p : points) {
    Eigen::Matrix<double, 3, 6> J;  // of a point by a perturbation of its pose on the right
    J << Eigen::Matrix3d::Identity(), -skew(p.cast<double>());
    sum += (J * covariance * J.transpose()).trace();
  }
  EXPECT_NEAR(point_uncertainty(points, covariance), std::sqrt(sum / 20.0), 1e-9);
}

TEST(OdometryQuality, GoodRegistrationsAreGoodAndSayWhatTheyKnow) {
  Judge judge;
  const ScanQuality q = judge.scan(kGood);
  EXPECT_EQ(q.state, good);
  EXPECT_EQ(q.doubt, Doubt::none);
  EXPECT_NEAR(q.point_sigma, kGood, 1e-12);
  EXPECT_NEAR(q.sigma(0), kGood / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(q.constraint, 1.0 / 3.0, 1e-12);
}

TEST(OdometryQuality, IsLostAfterFiveRegistrationsThatDoNotHold) {
  Judge judge;
  judge.scans(kGood, 10);
  EXPECT_EQ(judge.scans(kUnheld, 6), (std::vector{weak, weak, weak, weak, lost, lost}));
}

TEST(OdometryQuality, IsFoundAfterFiveGoodOnes) {
  Judge judge;
  judge.scans(kUnheld, 5);
  EXPECT_EQ(judge.scans(kGood, 4), std::vector(4, lost));
  EXPECT_EQ(judge.scan(kUncertain).state, lost);  // they are to be in a row
  EXPECT_EQ(judge.scans(kGood, 5), (std::vector{lost, lost, lost, lost, good}));
}

TEST(OdometryQuality, DoesNotFlickerByOneDoubtfulScan) {
  Judge judge;
  judge.scans(kGood, 3);
  EXPECT_EQ(judge.scan(kUncertain).state, good);
  EXPECT_EQ(judge.scan(kGood).state, good);
  EXPECT_EQ(judge.scans(kUncertain, 3), (std::vector{good, weak, weak}));
  EXPECT_EQ(judge.scans(kGood, 2), (std::vector{weak, good}));
}

// Each is known to 0.15 m, three quarters of the kernel's scale: 4.5 squares of it are eight scans,
// and the map is made of them.
TEST(OdometryQuality, ALongRowOfUncertainScansIsLost) {
  Judge judge;
  judge.scans(kGood, 10);
  EXPECT_EQ(judge.scans(kUncertain, 7).back(), weak);  // 7 * 0.75^2 = 3.9
  EXPECT_EQ(judge.scans(kUncertain, 2).back(), lost);  // 9 * 0.75^2 = 5.1
}

// A sensor that has moved by half a metre from scan to scan gets, within 0.5 s and by 20 m/s^2,
// 2.5 m from where it would be, and a registration catches another two metres.
TEST(OdometryQuality, AJumpThatNoMotionMakesIsLostAtOnce) {
  Judge judge;
  judge.scans(kGood, 10);
  EXPECT_EQ(judge.scan(kGood, 4.9, 0.5).state, good);
  const ScanQuality q = judge.scan(kGood, 5.1, 0.5);
  EXPECT_EQ(q.state, lost);
  EXPECT_EQ(q.doubt, Doubt::jump);
}

TEST(OdometryQuality, AGapIsJudgedByHowTheScanAfterItFits) {
  for (const auto& [step, fit, state, doubt] :
       {std::tuple(74.0, 1.0, good, Doubt::none), std::tuple(3.0, 2.0, weak, Doubt::short_gap),
        std::tuple(74.0, 2.0, lost, Doubt::long_gap), std::tuple(0.9, 2.0, good, Doubt::none)}) {
    Judge judge;
    judge.scans(kGood, 10);
    const ScanQuality q = judge.scan(kGood, 0.0, step, fit);
    EXPECT_EQ(q.state, state) << step << " s";
    EXPECT_EQ(q.doubt, doubt) << step << " s";
  }
}

TEST(OdometryQuality, ScansThatSawNothingMakeAGap) {
  Judge judge;
  judge.scans(kGood, 10);
  for (int i = 0; i < 60; ++i)
    EXPECT_EQ(judge.judge.predicted(0.1).state, OdometryState::predicted);
  EXPECT_EQ(judge.scan(kGood, 0.0, 0.1, 2.0).doubt, Doubt::long_gap);
  EXPECT_EQ(judge.scan(kGood, 0.0, 0.1, 2.0).doubt, Doubt::none);
}

// Two walls and a floor that all face across x: along it there is the weight along a plane alone.
TEST(OdometryQuality, NamesTheDirectionThatACorridorDoesNotHold) {
  constexpr double kAlong = 0.01, kPoints = 1000.0;
  ScanRegistration registration = known_to(kGood);
  registration.information = Matrix6d::Identity() * 1e5;
  for (int axis = 0; axis < 3; ++axis) {
    const double across = axis == 0 ? 0.0 : 0.5;
    registration.information(axis, axis) = kPoints * (kAlong + (1.0 - kAlong) * across);
  }
  Judge judge;
  const ScanQuality q = judge.scan(registration);
  EXPECT_EQ(q.doubt, Doubt::degenerate);
  EXPECT_EQ(q.weakest, 0);
  EXPECT_NEAR(q.constraint, kAlong / (1.0 + 2.0 * kAlong), 1e-12);
  EXPECT_EQ(judge.scan(registration).state, weak);
}

TEST(OdometryQuality, NothingFoundIsNotHeld) {
  Judge judge;
  const ScanQuality q = judge.scan(ScanRegistration{});
  EXPECT_EQ(q.doubt, Doubt::unheld);
  EXPECT_FALSE(std::isfinite(q.point_sigma));
}

TEST(OdometryQuality, GoesOnFromASavedStateAsIfNothingHadHappened) {
  Judge whole, first, second;
  for (Judge* judge : {&whole, &first}) judge->scans(kUnheld, 4);
  std::stringstream state;
  first.judge.save(state);
  second.judge.load(state);
  ASSERT_TRUE(state.good());
  for (const double sigma : {kUnheld, kGood, kGood, kGood, kGood, kGood})
    EXPECT_EQ(whole.scan(sigma).state, second.scan(sigma).state);
}

}  // namespace
}  // namespace groundloop
