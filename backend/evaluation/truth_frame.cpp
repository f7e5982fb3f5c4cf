#include "backend/evaluation/truth_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

namespace groundloop {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
// What odometry errs by over a stretch, for the weight of metres against radians alone.
constexpr double kTranslationShare = 0.02;
constexpr double kRotation = 0.5 / kDegrees;
constexpr std::size_t kMaxStretches = 400;

// The motion of both over one stretch of way.
struct Stretch {
  Eigen::Vector3d truth_turn, sensor_turn;  // rotation vectors
  Eigen::Matrix3d truth_rotation;
  Eigen::Vector3d truth_translation, sensor_translation;
  double length;  // m

  [[nodiscard]] Eigen::Vector3d turn_residual(const Pose& X) const {
    return (truth_turn - X.rotation * sensor_turn) / kRotation;
  }
  [[nodiscard]] Eigen::Vector3d translation_residual(const Pose& X) const {
    return (truth_translation + truth_rotation * X.translation - X.rotation * sensor_translation -
            X.translation) /
           (kTranslationShare * length + 0.01);
  }
};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Stretches of a fortieth of the way, within 0.5 and 20 m, each beginning half a stretch after the
// one before.
std::vector<Stretch> stretches_of(const std::vector<Pose>& estimate,
                                  const std::vector<Pose>& truth) {
  std::vector<double> way(estimate.size(), 0.0);
  for (std::size_t i = 1; i < estimate.size(); ++i)
    way[i] = way[i - 1] + (estimate[i].translation - estimate[i - 1].translation).norm();
  std::vector<Stretch> stretches;
  if (way.empty()) return stretches;
  const double length = std::clamp(way.back() / 40.0, 0.5, 20.0);
  const double apart = std::max(length / 2.0, way.back() / static_cast<double>(kMaxStretches));
  double next = 0.0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (way[i] < next) continue;
    const auto end = std::lower_bound(way.begin(), way.end(), way[i] + length);
    if (end == way.end()) break;
    next = way[i] + apart;
    const auto j = static_cast<std::size_t>(end - way.begin());
    const Pose A = truth[i].inverse() * truth[j];
    const Pose B = estimate[i].inverse() * estimate[j];
    stretches.push_back({log_so3(A.rotation), log_so3(B.rotation), A.rotation_matrix(),
                         A.translation, B.translation, way[j] - way[i]});
  }
  return stretches;
}

// Cauchy: a stretch on which odometry slipped says little of the frame.
double weight(double squared) { return 1.0 / (1.0 + squared / 9.0); }

double cost(const std::vector<Stretch>& stretches, const Pose& X) {
  double sum = 0.0;
  for (const Stretch& s : stretches) {
    sum += 9.0 *
           std::log1p((s.turn_residual(X).squaredNorm() + s.translation_residual(X).squaredNorm()) /
                      9.0);
  }
  return sum / static_cast<double>(stretches.size());
}

// The rotation that brings the sensor's turns and ways to the truth's, no lever taken into account.
Pose rotation_alone(const std::vector<Stretch>& stretches) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Stretch& s : stretches) {
    const double scale = kTranslationShare * s.length + 0.01;
    sum += s.truth_turn * s.sensor_turn.transpose() / (kRotation * kRotation);
    sum += s.truth_translation * s.sensor_translation.transpose() / (scale * scale);
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign[2] = -1.0;
  return {Eigen::Matrix3d(svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose()),
          Eigen::Vector3d::Zero()};
}

// Gauss-Newton over rotation and lever, perturbed as X.translation + d, X.rotation * exp(w).
// Returns the covariance, translation first.
Matrix6d refine(const std::vector<Stretch>& stretches, Pose& X) {
  // Directions that the motion says nothing of stay where they are: sensors sit within metres.
  constexpr double kLever = 5.0;
  Matrix6d information = Matrix6d::Zero();
  double squares = 0.0;
  for (int iteration = 0; iteration < 30; ++iteration) {
    information.setZero();
    information.topLeftCorner<3, 3>().diagonal().setConstant(1.0 / (kLever * kLever));
    Vector6d gradient = Vector6d::Zero();
    gradient.head<3>() = X.translation / (kLever * kLever);
    squares = 0.0;
    for (const Stretch& s : stretches) {
      Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
      Vector6d r;
      r << s.translation_residual(X), s.turn_residual(X);
      const double scale = kTranslationShare * s.length + 0.01;
      J.topLeftCorner<3, 3>() = (s.truth_rotation - Eigen::Matrix3d::Identity()) / scale;
      J.topRightCorner<3, 3>() = X.rotation_matrix() * skew(s.sensor_translation) / scale;
      J.bottomRightCorner<3, 3>() = X.rotation_matrix() * skew(s.sensor_turn) / kRotation;
      const double w = weight(r.squaredNorm());
      information += w * J.transpose() * J;
      gradient += w * J.transpose() * r;
      squares += w * r.squaredNorm();
    }
    const Vector6d step = -information.ldlt().solve(gradient);
    X = Pose(X.rotation * exp_so3(step.tail<3>()), X.translation + step.head<3>());
    if (step.norm() < 1e-9) break;
  }
  // Stretches overlap by half: half as many as there are count.
  const double freedom = std::max(1.0, 3.0 * static_cast<double>(stretches.size()) - 6.0);
  return information.inverse() * (2.0 * squares / freedom);
}

void describe(const std::vector<Stretch>& stretches, TruthFrame& frame) {
  std::vector<double> shares;
  std::vector<double> angles;
  for (const Stretch& s : stretches) {
    const double scale = kTranslationShare * s.length + 0.01;
    shares.push_back(100.0 * scale * s.translation_residual(frame.T_truth_sensor).norm() /
                     s.length);
    angles.push_back(kDegrees * kRotation * s.turn_residual(frame.T_truth_sensor).norm());
  }
  frame.disagreement_percent = median(std::move(shares));
  frame.disagreement_deg = median(std::move(angles));
  constexpr double kWorst = 25.0;  // percent of the way, and degrees: no odometry errs like this
  frame.fits = frame.disagreement_percent < kWorst && frame.disagreement_deg < kWorst;
}

// Poses of both at the same instants, `shift` after the estimate's stamps.
double cost_at(const Trajectory& estimate, const Trajectory& truth, double shift) {
  std::vector<Pose> estimated;
  std::vector<Pose> true_poses;
  const auto nanoseconds = static_cast<Nanoseconds>(std::llround(shift * 1e9));
  for (const StampedPose& pose : estimate) {
    const Nanoseconds stamp = pose.stamp + nanoseconds;
    if (stamp < truth.front().stamp || stamp > truth.back().stamp) continue;
    estimated.push_back(pose.pose);
    true_poses.push_back(pose_at(truth, stamp));
  }
  const std::vector<Stretch> stretches = stretches_of(estimated, true_poses);
  return stretches.size() < 10 ? -1.0 : cost(stretches, Pose());
}

}  // namespace

TruthFrame judge_truth_frame(const std::vector<Pose>& estimate, const std::vector<Pose>& truth,
                             const std::vector<FrameCandidate>& candidates, bool search) {
  TruthFrame frame;
  frame.name = candidates.front().name;
  frame.T_truth_sensor = candidates.front().T_truth_sensor;
  const std::vector<Stretch> stretches = stretches_of(estimate, truth);
  if (stretches.size() < 10) {
    frame.told = false;
    return frame;
  }
  constexpr double kBetter = 4.0;
  double lowest = cost(stretches, frame.T_truth_sensor);
  for (const FrameCandidate& candidate : candidates) {
    const double c = cost(stretches, candidate.T_truth_sensor);
    if (kBetter * c > lowest) continue;
    lowest = c;
    frame.name = candidate.name;
    frame.T_truth_sensor = candidate.T_truth_sensor;
  }
  Pose X = rotation_alone(stretches);
  const Matrix6d covariance = refine(stretches, X);
  if (const double c = cost(stretches, X); search && kBetter * c < lowest) {
    frame.name = "found from the motion";
    frame.T_truth_sensor = X;
    frame.found = true;
    frame.lever_deviation_m = std::sqrt(covariance.topLeftCorner<3, 3>().diagonal().maxCoeff());
    frame.rotation_deviation_deg =
        kDegrees * std::sqrt(covariance.bottomRightCorner<3, 3>().diagonal().maxCoeff());
  }
  describe(stretches, frame);
  return frame;
}

Trajectory in_sensor_frame(Trajectory truth, const Pose& T_truth_sensor) {
  for (StampedPose& pose : truth) pose.pose = pose.pose * T_truth_sensor;
  return truth;
}

double judge_truth_instant(const Trajectory& estimate, const Trajectory& truth, double period) {
  if (truth.size() < 2) return 0.0;
  constexpr double kBetter = 2.0;
  const double at_stamps = cost_at(estimate, truth, 0.0);
  double lowest = at_stamps;
  double best = 0.0;
  for (const double share : {-1.0, -0.5, 0.5, 1.0}) {
    const double c = cost_at(estimate, truth, share * period);
    if (c < 0.0 || c >= lowest) continue;
    lowest = c;
    best = share * period;
  }
  return kBetter * lowest < at_stamps ? best : 0.0;
}

Pose pose_at(const Trajectory& truth, Nanoseconds stamp) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), stamp,
                       [](const StampedPose& p, Nanoseconds s) { return p.stamp < s; });
  if (after == truth.end()) return truth.back().pose;
  if (after->stamp == stamp || after == truth.begin()) return after->pose;
  const StampedPose& before = *(after - 1);
  const double s =
      static_cast<double>(stamp - before.stamp) / static_cast<double>(after->stamp - before.stamp);
  return interpolate(before.pose, after->pose, s);
}

}  // namespace groundloop
