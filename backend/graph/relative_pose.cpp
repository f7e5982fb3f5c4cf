#include "backend/graph/relative_pose.hpp"

#include <Eigen/Cholesky>

namespace groundloop {

Matrix6d bounded_information(const Matrix6d& information) {
  Matrix6d bounded = information;
  bounded.diagonal().head<3>().array() += 1e-4;
  bounded.diagonal().tail<3>().array() += 1.0;
  return bounded;
}

Matrix6d covariance_of(const Matrix6d& information) {
  Eigen::LLT<Matrix6d> llt(information);
  if (llt.info() != Eigen::Success) llt.compute(bounded_information(information));
  return llt.solve(Matrix6d::Identity());
}

double squared_mahalanobis(const RelativePose& loop) {
  const Vector6d r = log_se3(loop.T_from_to);
  return r.dot(loop.covariance.ldlt().solve(r));
}

}  // namespace groundloop
