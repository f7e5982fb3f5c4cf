// How well odometry does, scan by scan: what a registration tells of itself, and from the row of
// them a state that does not flicker. A registration can be believed where it holds the scan: where
// the points are better known than the distance within which it may err unnoticed (the kernel's
// scale), and where the sensor could have moved as it says. Several in a row that do not, or one
// jump that no motion makes, and the way is lost; several good ones, and it goes on, from a place
// whose relation to what was before is not known.
//
// The limits are those of registration and of motion, not of a sensor; every one says why.
#pragma once

#include <cstddef>
#include <iosfwd>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/odometry/scan_registration.hpp"

namespace groundloop {

enum class OdometryState : int { good, weak, lost, predicted };
[[nodiscard]] const char* to_string(OdometryState state);

/// What speaks against a scan's pose, the least first.
enum class Doubt : int {
  none,
  unconverged,  ///< registration ran to its limit
  degenerate,   ///< nothing was seen that holds the scan along one direction
  uncertain,    ///< points are known to half the kernel's scale only
  poor_fit,     ///< hardly anything of what is usual fits the map
  unheld,       ///< points are not known to the kernel's scale
  short_gap,    ///< after a gap, a scan that fits the map poorly
  long_gap,     ///< likewise, and the gap is longer than a velocity is kept
  jump,         ///< farther from all predictions than a sensor can move
  unseen,       ///< predicted: too few points, a blocked view, or a scan that could not be read
};
[[nodiscard]] const char* to_string(Doubt doubt);
/// Whether a scan of this doubt is not connected to the one before: what was seen on either side
/// belongs to no common map.
[[nodiscard]] bool breaks(Doubt doubt);
/// Whether its pose is not known by its registration.
[[nodiscard]] bool unknown(Doubt doubt);

/// One scan's row. Its order leaves no padding: it goes into checkpoints as it is.
struct ScanQuality {
  OdometryState state = OdometryState::good;
  Doubt doubt = Doubt::none;
  int converged = 1;
  int weakest = 0;  ///< of tx ty tz rx ry rz: the direction in which the scan is known least
  Vector6d sigma = Vector6d::Zero();  ///< tx ty tz rx ry rz, m and rad, scan frame
  double correspondences = 0.0;
  double inlier_share = 0.0;
  double residual = 0.0;     ///< m
  double point_sigma = 0.0;  ///< m, rms over the points of the scan, by the covariance of its pose
  double constraint = 0.0;   ///< share of the translation's information in its weakest direction
  double fit = 0.0;          ///< mean distance from the map over what is usual; 0: not known
  double deviation = 0.0;    ///< from constant velocity, m
  double deviation_angle = 0.0;  ///< rad
};

/// What is to be judged of a registered scan.
struct RegistrationEvidence {
  const ScanRegistration& registration;
  const Points& points;  ///< that were registered, scan frame
  double fit = 0.0;      ///< as in ScanQuality
  double step = 0.0;     ///< s since the last scan
  double way = 0.0;      ///< m from the last scan's pose
  double jump = 0.0;     ///< m from the nearest of the predictions
  Pose deviation;        ///< from constant velocity
};

class OdometryJudge {
 public:
  struct Limits {
    double kernel = 0.2;         ///< scale of the last registration's kernel, m
    double reach = 2.0;          ///< that a registration catches a prediction from, m
    double along_plane = 0.01;   ///< weight of a residual along a plane
    double max_gap = 1.0;        ///< s
    double longest_coast = 5.0;  ///< that a velocity is kept through a gap, s
  };

  explicit OdometryJudge(const Limits& limits) : limits_(limits) {}

  /// The first scan, which begins the map.
  [[nodiscard]] ScanQuality first() const { return {}; }
  [[nodiscard]] ScanQuality registered(const RegistrationEvidence& evidence);
  /// A scan whose pose was predicted over `step` seconds.
  [[nodiscard]] ScanQuality predicted(double step);

  [[nodiscard]] OdometryState state() const { return state_; }

  /// Exact state for a resumable session.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  [[nodiscard]] Doubt doubt_of(const RegistrationEvidence& evidence,
                               const ScanQuality& quality) const;
  void enter(const ScanQuality& quality);

  Limits limits_;
  OdometryState state_ = OdometryState::good;
  int good_ = 0, doubtful_ = 0;  // scans in a row
  double uncertainty_ = 0.0;     // of the doubtful scans until now, summed, kernel^2
  int scans_ = 0;                // registered to the map
  double usual_way_ = 0.0;       // m from scan to scan
  double usual_inliers_ = 0.0;
  double unseen_ = 0.0;  // s of predicted scans until now
};

/// Root mean square of how far the points move, m, by the `covariance` of their pose, perturbed on
/// the right.
[[nodiscard]] double point_uncertainty(const Points& points, const Matrix6d& covariance);

}  // namespace groundloop
