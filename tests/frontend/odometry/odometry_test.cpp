#include "frontend/odometry/odometry.hpp"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// A box room of 40 x 24 x 8 m with pillars, seen from inside: 1024 x 32 rays cast in closed form.
class Room {
 public:
  [[nodiscard]] float range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    double nearest = 1e9;
    const Eigen::Vector3d low(-20, -12, -2), high(20, 12, 6);
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(direction(axis)) < 1e-12) continue;
      const double wall = direction(axis) > 0 ? high(axis) : low(axis);
      nearest = std::min(nearest, (wall - origin(axis)) / direction(axis));
    }
    for (const Eigen::Vector2d& pillar :
         {Eigen::Vector2d(8, 3), Eigen::Vector2d(-6, -5), Eigen::Vector2d(2, 9)}) {
      const Eigen::Vector2d d = direction.head<2>(), o = origin.head<2>() - pillar;
      const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1.0;
      const double root = b * b - a * c;
      if (root > 0 && (-b - std::sqrt(root)) / a > 0)
        nearest = std::min(nearest, (-b - std::sqrt(root)) / a);
    }
    return static_cast<float>(nearest);
  }
};

struct Drive {
  double speed = 2.0, yaw_rate = 0.2;  // m/s, rad/s
  [[nodiscard]] Pose at(double t) const {
    Vector6d twist = Vector6d::Zero();
    twist(0) = speed;
    twist(5) = yaw_rate;
    return Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-8, -2, 0)) * exp_se3(t * twist);
  }
};

// A sensor in the hand: pitch swings by 20 degrees at 0.5 Hz, so that its rate changes by 20
// degrees a second from one scan to the next.
struct Swing : Drive {
  [[nodiscard]] Pose at(double t) const {
    const double pitch = 20.0 * M_PI / 180.0 * std::sin(2.0 * M_PI * 0.5 * t);
    return Drive::at(t) * Pose(exp_so3({0.0, pitch, 0.0}), Eigen::Vector3d::Zero());
  }
};

double distance_from_wall(const Eigen::Vector3d& w) {
  double wall = std::min({std::abs(std::abs(w.x()) - 20.0), std::abs(std::abs(w.y()) - 12.0),
                          std::abs(w.z() + 2.0), std::abs(w.z() - 6.0)});
  for (const Eigen::Vector2d& pillar :
       {Eigen::Vector2d(8, 3), Eigen::Vector2d(-6, -5), Eigen::Vector2d(2, 9)}) {
    wall = std::min(wall, std::abs((w.head<2>() - pillar).norm() - 1.0));
  }
  return wall;
}

template <typename Way>
Scan sweep(const Way& drive, double start, double duration, bool moving) {
  Scan scan;
  scan.stamp = static_cast<Nanoseconds>(std::llround(start * 1e9));
  // A spinning sensor's columns are not locked to its scans; nor are they here.
  const double phase = std::fmod(start * 6.18033988, 1.0);
  for (int column = 0; column < 1024; ++column) {
    const double t = duration * column / 1024.0;
    const Pose T = drive.at(start + (moving ? t : 0.0));
    for (int ring = 0; ring < 32; ++ring) {
      const double azimuth = 2 * M_PI * (column + phase) / 1024.0,
                   elevation = -0.15 + 0.016 * (ring + phase);
      const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      const double r = Room().range(T.translation, T.rotation * ray);
      scan.points.emplace_back((r * ray).cast<float>());
      if (moving) scan.times.push_back(static_cast<float>(t));
    }
  }
  return scan;
}

TEST(Odometry, FollowsASimulatedDriveWithMovingSweeps) {
  const Drive drive;
  OdometryOptions options;
  options.voxel_size = 0.5;  // a room wants finer voxels than a street
  Odometry odometry(options);
  odometry.start(sweep(drive, 0.0, 0.1, true), sweep(drive, 0.1, 0.1, true));
  // The map of the first scans holds single rings, whose sampling pulls by decimetres: measured
  // from the tenth scan on.
  double worst = 0.0;
  Pose reference, estimate_at_reference;
  for (int i = 0; i < 50; ++i) {
    const RegisteredScan result = odometry.add(sweep(drive, 0.1 * i, 0.1, true), "scan");
    if (i == 10) {
      reference = drive.at(0.1 * i);
      estimate_at_reference = result.T_world_scan;
    }
    if (i <= 10) continue;
    const Pose expected = reference.inverse() * drive.at(0.1 * i);
    const Pose estimate = estimate_at_reference.inverse() * result.T_world_scan;
    worst = std::max(worst, (estimate.translation - expected.translation).norm());
  }
  EXPECT_LT(worst, 0.05);
}

TEST(Odometry, DeskewingPutsPointsBackOnTheWalls) {
  Drive drive;
  drive.yaw_rate = 1.0;
  const Scan moving = sweep(drive, 0.0, 0.1, true);
  Vector6d twist = Vector6d::Zero();
  twist(0) = drive.speed;
  twist(5) = drive.yaw_rate;
  const auto worst_distance_from_wall = [&](const Points& points) {
    double worst = 0.0;
    for (const Eigen::Vector3f& p : points) {
      worst =
          std::max(worst, distance_from_wall(drive.at(0.0) * Eigen::Vector3d(p.cast<double>())));
    }
    return worst;
  };
  EXPECT_GT(worst_distance_from_wall(deskew_and_crop(moving, {}, 0.0, 0.0, 100.0)), 0.2);
  EXPECT_LT(worst_distance_from_wall(deskew_and_crop(moving, {twist}, 0.0, 0.0, 100.0)), 1e-4);
}

TEST(Odometry, DeskewingByAVelocityThatChangesPutsPointsBackOnTheWalls) {
  // Pitch about the sensor by 0.3 t + 2 t^2.
  struct Nod {
    [[nodiscard]] Pose at(double t) const {
      return {exp_so3({0.0, 0.3 * t + 2.0 * t * t, 0.0}), Eigen::Vector3d(-8, -2, 0)};
    }
  };
  SensorMotion motion;
  motion.velocity(4) = 0.3 + 4.0 * 0.05;  // in the middle of the sweep
  motion.change(4) = 4.0;
  const Points points = deskew_and_crop(sweep(Nod{}, 0.0, 0.1, true), motion, 0.05, 0.0, 100.0);
  double worst = 0.0;
  for (const Eigen::Vector3f& p : points) {
    worst = std::max(worst, distance_from_wall(Nod{}.at(0.05) * Eigen::Vector3d(p.cast<double>())));
  }
  EXPECT_LT(worst, 1e-4);
}

// Root mean square distance of deskewed points from the walls, placed by the true poses, m.
double blur_of_a_swinging_sensor(double swing_deg) {
  const Swing swing;
  OdometryOptions options;
  options.voxel_size = 0.5;
  options.swing_deg = swing_deg;
  Odometry odometry(options);
  odometry.start(sweep(swing, 0.0, 0.1, true), sweep(swing, 0.1, 0.1, true));
  double squares = 0.0;
  std::size_t count = 0;
  for (int i = 0; i < 40; ++i) {
    const RegisteredScan result = odometry.add(sweep(swing, 0.1 * i, 0.1, true), "scan");
    if (i <= 20) continue;
    for (const Eigen::Vector3f& p : result.points) {
      const double d = distance_from_wall(swing.at(0.1 * i) * Eigen::Vector3d(p.cast<double>()));
      squares += d * d;
    }
    count += result.points.size();
  }
  return std::sqrt(squares / static_cast<double>(count));
}

TEST(Odometry, MeasuresTheTurnOfASwingingSensorWithinItsSweeps) {
  EXPECT_GT(blur_of_a_swinging_sensor(180.0), 0.06);
  EXPECT_LT(blur_of_a_swinging_sensor(OdometryOptions().swing_deg), 0.015);
}

TEST(Odometry, GivesTheSameBytesForEveryThreadCount) {
  const auto run = [](int threads) {
    set_thread_count(threads);
    Odometry odometry{OdometryOptions{}};
    for (int i = 0; i < 8; ++i) odometry.add(sweep(Swing{}, 0.1 * i, 0.1, true), "scan");
    std::ostringstream state;
    odometry.save(state);
    set_thread_count(0);
    return state.str();
  };
  EXPECT_EQ(run(1), run(2));
}

TEST(Odometry, GoesOnFromASavedStateAsIfNothingHadHappened) {
  Odometry whole{OdometryOptions{}}, first{OdometryOptions{}}, second{OdometryOptions{}};
  for (int i = 0; i < 4; ++i) whole.add(sweep(Swing{}, 0.1 * i, 0.1, true), "scan");
  for (int i = 0; i < 4; ++i) first.add(sweep(Swing{}, 0.1 * i, 0.1, true), "scan");
  std::stringstream state;
  first.save(state);
  second.load(state);
  const Pose a = whole.add(sweep(Swing{}, 0.4, 0.1, true), "scan").T_world_scan;
  const Pose b = second.add(sweep(Swing{}, 0.4, 0.1, true), "scan").T_world_scan;
  EXPECT_EQ(a.matrix(), b.matrix());
}

// Few points, none, or nothing but NaN: the scan is predicted and the next goes on.
TEST(Odometry, PredictsScansOfTooFewPoints) {
  const Drive drive;
  Scan few, none, nan;
  few.points.assign(5, Eigen::Vector3f(1, 2, 3));
  nan.points.assign(5000, Eigen::Vector3f::Constant(std::nanf("")));
  OdometryOptions options;
  options.voxel_size = 0.5;
  Odometry odometry(options);
  odometry.start(sweep(drive, 0.0, 0.1, true), sweep(drive, 0.1, 0.1, true));
  Pose last;
  for (int i = 0; i < 30; ++i) {
    Scan scan = i == 20 ? few : i == 21 ? none : i == 22 ? nan : sweep(drive, 0.1 * i, 0.1, true);
    scan.stamp = static_cast<Nanoseconds>(i) * 100'000'000;
    const RegisteredScan result = odometry.add(scan, "scan");
    EXPECT_EQ(result.predicted, i >= 20 && i < 23) << i;
    EXPECT_EQ(result.points.empty(), result.predicted) << i;
    last = result.T_world_scan;
  }
  EXPECT_EQ(odometry.predicted_scans(), 3U);
  const Eigen::Vector3d expected = (drive.at(0.0).inverse() * drive.at(2.9)).translation;
  EXPECT_LT((last.translation - expected).norm(), 0.25);
}

TEST(Odometry, BeginsWithTheFirstScanThatHasPoints) {
  const Drive drive;
  Odometry odometry{OdometryOptions{}};
  odometry.start(Scan{}, sweep(drive, 0.1, 0.1, true));
  odometry.add(Scan{}, "scan 0");
  EXPECT_FALSE(odometry.started());
  EXPECT_FALSE(odometry.add(sweep(drive, 0.1, 0.1, true), "scan 1").predicted);
  EXPECT_TRUE(odometry.started());
}

// Key frames by distance and turn, as people keep them: 0.2 m and 8 degrees apart at any interval,
// now and then to the other side.
TEST(Odometry, FollowsKeyFramesAtUnevenTimes) {
  OdometryOptions options;
  options.voxel_size = 0.5;
  Odometry odometry(options);
  Pose truth(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-8, -2, 0));
  const Pose first = truth;
  Nanoseconds stamp = 0;
  Pose last;
  for (int i = 0; i < 40; ++i) {
    struct Still {
      Pose pose;
      [[nodiscard]] Pose at(double) const { return pose; }
    };
    Scan scan = sweep(Still{truth}, 0.0, 0.1, false);
    scan.stamp = stamp;
    last = odometry.add(scan, "scan").T_world_scan;
    EXPECT_LT(((first * last).translation - truth.translation).norm(), 0.1) << i;
    stamp += (i % 5 == 0 ? 30 : i % 3 + 1) * Nanoseconds{100'000'000};
    const double turn = (i % 7 < 4 ? 8.0 : -8.0) * M_PI / 180.0;
    truth = truth * Pose(exp_so3({0.0, 0.0, turn}), Eigen::Vector3d(0.2, 0.0, 0.0));
  }
}

TEST(AdaptiveThreshold, IsTheRootMeanSquareOfDeviationsAndForgetsOne) {
  AdaptiveThreshold threshold(2.0, 0.1);
  threshold.learn(0.05);  // below the least motion
  EXPECT_DOUBLE_EQ(threshold.value(), 2.0);
  threshold.learn(1.0);
  EXPECT_DOUBLE_EQ(threshold.value(), std::sqrt((4.0 + 1.0) / 2.0));
  threshold.learn(3.0);
  EXPECT_DOUBLE_EQ(threshold.value(), std::sqrt((4.0 + 1.0 + 9.0) / 3.0));
  threshold.learn(50.0);
  for (int i = 0; i < 1500; ++i) threshold.learn(0.3);
  EXPECT_NEAR(threshold.value(), 0.3, 0.01);
}

// A lorry before the sensor: a scan of many points, all on one thing that is near.
TEST(Odometry, PredictsScansWhoseViewIsBlockedAndGoesOn) {
  const Drive drive;
  Scan lorry = sweep(drive, 0.0, 0.1, false);
  for (Eigen::Vector3f& p : lorry.points) p *= 1.2F / p.norm();
  OdometryOptions options;
  options.voxel_size = 0.5;
  options.blocked_share = 0.3;  // a room fills fewer voxels than a street
  Odometry odometry(options);
  odometry.start(sweep(drive, 0.0, 0.1, true), sweep(drive, 0.1, 0.1, true));
  Pose last;
  for (int i = 0; i < 30; ++i) {
    const bool blocked = i >= 20 && i < 24;
    if (blocked) lorry.stamp = static_cast<Nanoseconds>(i) * 100'000'000;
    const RegisteredScan result =
        odometry.add(blocked ? lorry : sweep(drive, 0.1 * i, 0.1, true), "scan");
    EXPECT_EQ(result.points.empty(), blocked) << i;
    last = result.T_world_scan;
  }
  EXPECT_EQ(odometry.predicted_scans(), 4U);
  const Eigen::Vector3d expected = (drive.at(0.0).inverse() * drive.at(2.9)).translation;
  EXPECT_LT((last.translation - expected).norm(), 0.25);
}

TEST(Odometry, ABlockedViewThatLastsIsRegisteredAfterAll) {
  const Drive drive;
  Scan lorry = sweep(drive, 0.0, 0.1, false);
  for (Eigen::Vector3f& p : lorry.points) p *= 1.2F / p.norm();
  OdometryOptions options;
  options.blocked_share = 0.3;
  options.max_blocked = 3;
  Odometry odometry(options);
  odometry.add(sweep(drive, 0.0, 0.1, true), "scan");
  std::size_t registered = 0;
  for (int i = 1; i < 8; ++i) {
    lorry.stamp = static_cast<Nanoseconds>(i) * 100'000'000;
    registered += odometry.add(lorry, "scan").points.empty() ? 0 : 1;
  }
  EXPECT_EQ(odometry.predicted_scans(), 3U);
  EXPECT_EQ(registered, 4U);
}

TEST(Odometry, SurvivesStampsThatStandStillAndAGap) {
  Odometry odometry{OdometryOptions{}};
  const Drive drive;
  for (const double t : {0.0, 0.1, 0.2, 0.2, 0.3}) odometry.add(sweep(drive, t, 0.1, true), "scan");
  const RegisteredScan after = odometry.add(sweep(drive, 1.8, 0.1, true), "scan");
  EXPECT_TRUE(after.T_world_scan.translation.allFinite());
  const Eigen::Vector3d expected = (drive.at(0.0).inverse() * drive.at(1.8)).translation;
  EXPECT_LT((after.T_world_scan.translation - expected).norm(), 0.3);
}

}  // namespace
}  // namespace groundloop
