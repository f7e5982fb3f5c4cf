#include "backend/mapping/odometry_trust.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace groundloop {
namespace {

// A scan in twenty that is weakly held is a stretch to look at; fewer are a doorway, a bend.
constexpr double kWeakShare = 0.05;
// Of a step that is not known: a car in a town goes so fast, and even at rest a registration that
// holds nothing is off by metres and by as much as a turn of the head.
constexpr double kSpeed = 10.0, kLeast = 2.0;  // m/s, m
constexpr double kTurn = 1.0;                  // rad

double seconds_between(const StampedPose& first, const StampedPose& then) {
  return static_cast<double>(then.stamp - first.stamp) * 1e-9;
}

}  // namespace

OdometryTrust trust_of(const std::vector<ScanQuality>& scans, const Trajectory& odometry) {
  OdometryTrust trust;
  bool was_lost = false;
  std::size_t weak_since = 0;  // the first of the weak scans until now
  for (std::size_t i = 0; i < scans.size() && i < odometry.size(); ++i) {
    const ScanQuality& q = scans[i];
    ++trust.scans.at(static_cast<std::size_t>(q.state));
    // Scans that are predicted amid lost ones belong to the stretch.
    if (q.state == OdometryState::predicted) continue;
    const bool lost = q.state == OdometryState::lost;
    if (q.state == OdometryState::good) weak_since = i + 1;
    if (lost) {
      const auto since_start = [&](std::size_t scan) {
        return seconds_between(odometry.front(), odometry[scan]);
      };
      const std::size_t from = std::min(weak_since, i);
      if (!was_lost) trust.lost.push_back({from, i, since_start(from), 0.0, q.doubt});
      trust.lost.back().last_scan = i;
      trust.lost.back().to_s = since_start(i);
      weak_since = i + 1;
    }
    was_lost = lost;
  }
  const auto weak = static_cast<double>(trust.count(OdometryState::weak));
  if (!trust.lost.empty()) {
    trust.state = OdometryState::lost;
  } else if (weak >= kWeakShare * static_cast<double>(std::max<std::size_t>(1, trust.size()))) {
    trust.state = OdometryState::weak;
  }
  return trust;
}

std::vector<Vector6d> loose_steps(const std::vector<ScanQuality>& scans,
                                  const Trajectory& odometry) {
  std::vector<Vector6d> loose(odometry.size(), Vector6d::Zero());
  std::size_t seen = 0;  // the last scan whose pose was not predicted
  for (std::size_t i = 1; i < odometry.size() && i < scans.size(); ++i) {
    if (scans[i].state == OdometryState::predicted) continue;
    if (unknown(scans[i].doubt)) {
      const double seconds = std::max(0.0, seconds_between(odometry[seen], odometry[i]));
      const double way = kLeast + kSpeed * seconds;
      loose[i].head<3>().setConstant(way * way);
      loose[i].tail<3>().setConstant(kTurn * kTurn);
    }
    seen = i;
  }
  return loose;
}

std::string warning_of(const OdometryTrust& trust) {
  const auto share = [&](OdometryState state) {
    return 100.0 * static_cast<double>(trust.count(state)) /
           static_cast<double>(std::max<std::size_t>(1, trust.size()));
  };
  if (trust.state == OdometryState::lost) {
    const LostStretch& first = trust.lost.front();
    const std::string times =
        trust.lost.size() == 1 ? "once" : fmt::format("{} times", trust.lost.size());
    return fmt::format(
        "odometry is LOST from scan {} on, {:.1f} s after the start ({}): only the {} scans before "
        "it are to be trusted as they are; it lost its way {}, {} of {} scans ({:.1f} %) are lost",
        first.first_scan, first.from_s, to_string(first.reason), first.first_scan, times,
        trust.count(OdometryState::lost), trust.size(), share(OdometryState::lost));
  }
  if (trust.state == OdometryState::weak) {
    return fmt::format(
        "odometry is weak, held by little of what the sensor saw, at {} of {} scans ({:.1f} %)",
        trust.count(OdometryState::weak), trust.size(), share(OdometryState::weak));
  }
  return {};
}

}  // namespace groundloop
