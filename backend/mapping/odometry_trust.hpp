// How much of an odometry is to be trusted: its scans by state, the stretches where it was lost,
// and one sentence that says so.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/trajectory.hpp"
#include "frontend/odometry/odometry_quality.hpp"

namespace groundloop {

/// Scans in a row in the state lost, and the weak ones that led there.
struct LostStretch {
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;  ///< included
  double from_s = 0.0;        ///< since the first scan's stamp
  double to_s = 0.0;
  Doubt reason = Doubt::none;  ///< of its first scan in the state lost
};

struct OdometryTrust {
  OdometryState state = OdometryState::good;  ///< of the whole: good, weak or lost
  std::array<std::size_t, 4> scans{};         ///< by state
  std::vector<LostStretch> lost;

  [[nodiscard]] std::size_t count(OdometryState s) const {
    return scans.at(static_cast<std::size_t>(s));
  }
  [[nodiscard]] std::size_t size() const { return scans[0] + scans[1] + scans[2] + scans[3]; }
};

/// The whole is lost where any scan is: what comes after is not connected to what was before. It is
/// weak where one scan in twenty is. `odometry` has one pose a scan.
[[nodiscard]] OdometryTrust trust_of(const std::vector<ScanQuality>& scans,
                                     const Trajectory& odometry);

/// Variances, tx ty tz rx ry rz, that the step to each scan has beside odometry's random walk: a
/// scan whose registration says that its pose is not known may be wherever it could have got to.
[[nodiscard]] std::vector<Vector6d> loose_steps(const std::vector<ScanQuality>& scans,
                                                const Trajectory& odometry);

/// One sentence; empty where odometry is good throughout.
[[nodiscard]] std::string warning_of(const OdometryTrust& trust);

}  // namespace groundloop
