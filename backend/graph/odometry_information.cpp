#include "backend/graph/odometry_information.hpp"

#include <algorithm>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

double square(double x) { return x * x; }

Vector6d variances(const Pose& step, const OdometryInformationOptions& options) {
  const double way = step.translation.norm();
  const double turn = rotation_angle(step.rotation);
  Vector6d v;
  v.head<3>().setConstant(square(options.translation) * way + square(options.translation_floor));
  v.tail<3>().setConstant(square(options.rotation) * way +
                          square(options.rotation_per_turn) * turn +
                          square(options.rotation_floor));
  return v;
}

}  // namespace

OdometryInformationOptions scaled(OdometryInformationOptions options, double scale) {
  options.translation *= scale;
  options.rotation *= scale;
  options.rotation_per_turn *= scale;
  options.translation_floor *= scale;
  options.rotation_floor *= scale;
  return options;
}

Matrix6d odometry_covariance(const Pose& T_previous_current,
                             const OdometryInformationOptions& options) {
  return variances(T_previous_current, options).asDiagonal();
}

Matrix6d odometry_information(const Pose& T_previous_current,
                              const OdometryInformationOptions& options) {
  return variances(T_previous_current, options).cwiseInverse().asDiagonal();
}

RelativePose compose_odometry(std::span<const Pose> T_world_scan, std::size_t from, std::size_t to,
                              const OdometryInformationOptions& options,
                              std::span<const Vector6d> loose) {
  check(from <= to && to < T_world_scan.size(), "compose_odometry: scans in order and range");
  RelativePose chain;
  for (std::size_t i = from; i < to; ++i) {
    const Pose step = T_world_scan[i].inverse() * T_world_scan[i + 1];
    Matrix6d covariance = odometry_covariance(step, options);
    if (!loose.empty()) covariance.diagonal() += loose[i + 1];
    chain = chain * RelativePose{step, covariance};
  }
  // The product of the steps, without their rounding.
  chain.T_from_to = T_world_scan[from].inverse() * T_world_scan[to];
  return chain;
}

OdometryChain::OdometryChain(std::span<const Pose> T_world_scan,
                             const OdometryInformationOptions& options) {
  T_first_scan_.reserve(T_world_scan.size());
  covariance_.reserve(T_world_scan.size());
  for (std::size_t i = 0; i < T_world_scan.size(); ++i) {
    T_first_scan_.push_back(T_world_scan.front().inverse() * T_world_scan[i]);
    if (i == 0) {
      covariance_.emplace_back(Matrix6d::Zero());
      continue;
    }
    const Pose step = T_world_scan[i - 1].inverse() * T_world_scan[i];
    const Matrix6d carry = adjoint(T_first_scan_.back());
    covariance_.emplace_back(covariance_.back() +
                             carry * odometry_covariance(step, options) * carry.transpose());
  }
}

RelativePose OdometryChain::between(std::size_t from, std::size_t to) const {
  check(std::max(from, to) < T_first_scan_.size(), "OdometryChain: scan in range");
  const Matrix6d carry = adjoint(T_first_scan_[to].inverse());
  // Steps are independent: what lies between is the difference of the sums.
  const Matrix6d difference = from <= to ? Matrix6d(covariance_[to] - covariance_[from])
                                         : Matrix6d(covariance_[from] - covariance_[to]);
  return {T_first_scan_[from].inverse() * T_first_scan_[to],
          carry * difference * carry.transpose()};
}

}  // namespace groundloop
