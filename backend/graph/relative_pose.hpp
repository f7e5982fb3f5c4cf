// A relative pose with its covariance, and how covariance travels through composition and inversion
// (first order; Mangelson et al., TRO 2020). The perturbation stands on the right of the pose, as
// everywhere in groundloop, ordered (translation, rotation) in metres and radians.
#pragma once

#include "frontend/core/pose.hpp"

namespace groundloop {

/// T exp(xi), xi of zero mean and this covariance.
struct RelativePose {
  Pose T_from_to;
  Matrix6d covariance = Matrix6d::Zero();
};

/// a to c from a to b and b to c, errors independent: b's error stays, a's is carried to frame c.
[[nodiscard]] inline RelativePose operator*(const RelativePose& a_b, const RelativePose& b_c) {
  const Matrix6d carry = adjoint(b_c.T_from_to.inverse());
  return {a_b.T_from_to * b_c.T_from_to,
          carry * a_b.covariance * carry.transpose() + b_c.covariance};
}

[[nodiscard]] inline RelativePose inverse(const RelativePose& a_b) {
  const Matrix6d carry = adjoint(a_b.T_from_to);
  return {a_b.T_from_to.inverse(), carry * a_b.covariance * carry.transpose()};
}

/// The inverse; of information that has none, as that of an open direction is taken to be known to
/// 100 m and 1 rad.
[[nodiscard]] Matrix6d covariance_of(const Matrix6d& information);
/// Information that has an inverse: the same bound in every direction.
[[nodiscard]] Matrix6d bounded_information(const Matrix6d& information);

/// Squared Mahalanobis distance of the pose from the identity: log' covariance^-1 log.
[[nodiscard]] double squared_mahalanobis(const RelativePose& loop);

}  // namespace groundloop
