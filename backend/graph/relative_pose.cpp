#include "backend/graph/relative_pose.hpp"

#include <Eigen/Cholesky>

namespace groundloop {

double squared_mahalanobis(const RelativePose& loop) {
  const Vector6d r = log_se3(loop.T_from_to);
  return r.dot(loop.covariance.ldlt().solve(r));
}

}  // namespace groundloop
