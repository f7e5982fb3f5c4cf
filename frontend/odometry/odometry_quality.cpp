#include "frontend/odometry/odometry_quality.hpp"

#include <algorithm>
#include <cmath>
#include <istream>
#include <limits>
#include <ostream>

#include <Eigen/Eigenvalues>

#include "frontend/core/binary_io.hpp"

namespace groundloop {
namespace {

// Twice gravity: what a car that brakes hard and a hand that shakes stay below for as long as a
// step takes.
constexpr double kAcceleration = 20.0;  // m/s^2
// Scans of a map before which no way is usual yet.
constexpr int kSettled = 3;
// The map that a scan is registered to is made of those before it. Where they were known to the
// kernel's scale each, five in a row, or less well and longer, it is not known to twice that scale
// any more, and registration holds on to anything. In squares of the kernel's scale.
constexpr double kLostUncertainty = 4.5;
// So many good ones in a row, and it is the map that holds them.
constexpr int kFoundAfter = 5;
constexpr int kWeakAfter = 2, kGoodAfter = 2;
// A scan with this share of the usual inliers fits hardly, one this much farther from the map than
// usual fits poorly after a gap.
constexpr double kFewInliers = 0.4;
constexpr double kPoorFit = 1.5;
// Weight of the newest scan in running means.
constexpr double kGain = 0.05;

// Along planes that all face across, a pose has this share of its information by the weight along a
// plane alone; twice as much is hardly more than that.
double degenerate_share(double along_plane) {
  return 2.0 * along_plane / (1.0 + 2.0 * along_plane);
}

enum class Grade { good, doubtful, bad, broken };

Grade grade_of(Doubt doubt) {
  switch (doubt) {
    case Doubt::none:
      return Grade::good;
    case Doubt::unconverged:
    case Doubt::degenerate:
    case Doubt::uncertain:
      return Grade::doubtful;
    case Doubt::poor_fit:
    case Doubt::unheld:
    case Doubt::short_gap:
    case Doubt::unseen:
      return Grade::bad;
    case Doubt::long_gap:
    case Doubt::jump:
      return Grade::broken;
  }
  return Grade::bad;
}

// Sums over points that their mean square displacement by any covariance follows from.
struct Lever {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
};

Lever lever_of(const Points& points) {
  Lever lever;
  if (points.empty()) return lever;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>();
    lever.mean += p;
    lever.square += p * p.transpose();
  }
  lever.mean /= static_cast<double>(points.size());
  lever.square /= static_cast<double>(points.size());
  return lever;
}

// A point p moves by t + w x p = [I | -skew(p)] (t, w).
double mean_square(const Lever& lever, const Matrix6d& covariance) {
  const Eigen::Matrix3d turning = lever.square.trace() * Eigen::Matrix3d::Identity() - lever.square;
  return covariance.topLeftCorner<3, 3>().trace() +
         2.0 * (covariance.topRightCorner<3, 3>() * skew(lever.mean)).trace() +
         (covariance.bottomRightCorner<3, 3>() * turning).trace();
}

// Turns count by what they move at the points' usual distance.
int weakest_direction(const Matrix6d& covariance, double distance) {
  Vector6d units;
  units << 1.0, 1.0, 1.0, distance, distance, distance;
  const Matrix6d scaled = units.asDiagonal() * covariance * units.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scaled);
  Eigen::Index weakest = 0;
  solver.eigenvectors().col(5).cwiseAbs().maxCoeff(&weakest);
  return static_cast<int>(weakest);
}

}  // namespace

static_assert(sizeof(ScanQuality) == 4 * sizeof(int) + 14 * sizeof(double));

const char* to_string(OdometryState state) {
  switch (state) {
    case OdometryState::good:
      return "good";
    case OdometryState::weak:
      return "weak";
    case OdometryState::lost:
      return "lost";
    case OdometryState::predicted:
      return "predicted";
  }
  return "";
}

const char* to_string(Doubt doubt) {
  switch (doubt) {
    case Doubt::none:
      return "";
    case Doubt::unconverged:
      return "no convergence";
    case Doubt::degenerate:
      return "one direction is not held";
    case Doubt::uncertain:
      return "weakly held";
    case Doubt::poor_fit:
      return "hardly fits the map";
    case Doubt::unheld:
      return "not held by what was seen";
    case Doubt::short_gap:
      return "gap";
    case Doubt::long_gap:
      return "gap too long to bridge";
    case Doubt::jump:
      return "jump";
    case Doubt::unseen:
      return "not seen";
  }
  return "";
}

bool breaks(Doubt doubt) { return grade_of(doubt) == Grade::broken; }

bool unknown(Doubt doubt) { return grade_of(doubt) >= Grade::bad && doubt != Doubt::unseen; }

double point_uncertainty(const Points& points, const Matrix6d& covariance) {
  return std::sqrt(std::max(0.0, mean_square(lever_of(points), covariance)));
}

ScanQuality OdometryJudge::registered(const RegistrationEvidence& evidence) {
  const ScanRegistration& registration = evidence.registration;
  ScanQuality quality;
  quality.converged = registration.converged ? 1 : 0;
  quality.correspondences = static_cast<double>(registration.correspondences);
  quality.inlier_share = registration.inlier_share;
  quality.residual = registration.residual;
  quality.fit = evidence.fit;
  quality.deviation = evidence.deviation.translation.norm();
  quality.deviation_angle = rotation_angle(evidence.deviation.rotation);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(registration.information);
  // Six directions from nothing, or from a handful of points, are not known at all.
  const bool solvable = solver.eigenvalues()(0) > 1e-12 * solver.eigenvalues()(5);
  if (solvable) {
    const Matrix6d covariance =
        registration.information.inverse() * registration.residual * registration.residual;
    const Lever lever = lever_of(evidence.points);
    quality.sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    quality.point_sigma = std::sqrt(std::max(0.0, mean_square(lever, covariance)));
    quality.weakest = weakest_direction(covariance, std::sqrt(lever.square.trace()));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> translation(
        registration.information.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
    quality.constraint = translation.eigenvalues()(0) / translation.eigenvalues().sum();
  } else {
    quality.sigma.setConstant(std::numeric_limits<double>::infinity());
    quality.point_sigma = std::numeric_limits<double>::infinity();
  }
  quality.doubt = doubt_of(evidence, quality);
  enter(quality);
  quality.state = state_;

  ++scans_;
  unseen_ = 0.0;
  const double gain = std::max(kGain, 1.0 / scans_);
  // A jump is no usual way.
  if (quality.doubt < Doubt::short_gap) usual_way_ += gain * (evidence.way - usual_way_);
  usual_inliers_ += gain * (quality.inlier_share - usual_inliers_);
  return quality;
}

Doubt OdometryJudge::doubt_of(const RegistrationEvidence& evidence,
                              const ScanQuality& quality) const {
  const double step = std::max(0.0, evidence.step) + unseen_;
  const bool settled = scans_ >= kSettled;
  // Stamps that are wrong, or assumed, make steps of one and a half or two of the usual ones.
  const double possible = limits_.reach + usual_way_ + 0.5 * kAcceleration * step * step;
  if (settled && evidence.jump > possible) return Doubt::jump;
  if (settled && step > limits_.max_gap && quality.fit > kPoorFit)
    return step > limits_.longest_coast ? Doubt::long_gap : Doubt::short_gap;
  if (!(quality.point_sigma < limits_.kernel)) return Doubt::unheld;
  if (settled && quality.converged == 0 && quality.inlier_share < kFewInliers * usual_inliers_)
    return Doubt::poor_fit;
  if (quality.point_sigma > 0.5 * limits_.kernel) return Doubt::uncertain;
  if (quality.constraint < degenerate_share(limits_.along_plane)) return Doubt::degenerate;
  return quality.converged == 1 ? Doubt::none : Doubt::unconverged;
}

void OdometryJudge::enter(const ScanQuality& quality) {
  const Grade grade = grade_of(quality.doubt);
  good_ = grade == Grade::good ? good_ + 1 : 0;
  doubtful_ = grade == Grade::good ? 0 : doubtful_ + 1;
  if (grade >= Grade::bad) {
    uncertainty_ += 1.0;
  } else if (quality.doubt == Doubt::uncertain) {
    uncertainty_ += std::pow(quality.point_sigma / limits_.kernel, 2);
  } else if (good_ >= kGoodAfter) {
    uncertainty_ = 0.0;
  }
  if (grade == Grade::broken || uncertainty_ > kLostUncertainty) {
    state_ = OdometryState::lost;
  } else if (state_ == OdometryState::lost) {
    if (good_ >= kFoundAfter) state_ = OdometryState::good;
  } else if (grade == Grade::bad || doubtful_ >= kWeakAfter) {
    state_ = OdometryState::weak;
  } else if (good_ >= kGoodAfter) {
    state_ = OdometryState::good;
  }
}

ScanQuality OdometryJudge::predicted(double step) {
  unseen_ += std::max(0.0, step);
  ScanQuality quality;
  quality.state = OdometryState::predicted;
  quality.doubt = Doubt::unseen;
  quality.converged = 0;
  quality.sigma.setConstant(std::numeric_limits<double>::infinity());
  quality.point_sigma = std::numeric_limits<double>::infinity();
  return quality;
}

void OdometryJudge::save(std::ostream& out) const {
  put(out, state_);
  put(out, good_);
  put(out, doubtful_);
  put(out, uncertainty_);
  put(out, scans_);
  put(out, usual_way_);
  put(out, usual_inliers_);
  put(out, unseen_);
}

void OdometryJudge::load(std::istream& in) {
  get(in, state_);
  get(in, good_);
  get(in, doubtful_);
  get(in, uncertainty_);
  get(in, scans_);
  get(in, usual_way_);
  get(in, usual_inliers_);
  get(in, unseen_);
  const bool known = state_ >= OdometryState::good && state_ <= OdometryState::predicted;
  if (!known || !std::isfinite(usual_way_ + usual_inliers_ + unseen_ + uncertainty_))
    in.setstate(std::ios::failbit);
}

}  // namespace groundloop
