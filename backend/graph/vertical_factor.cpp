#include "backend/graph/vertical_factor.hpp"

#include <Eigen/Cholesky>

#include "backend/graph/factors.hpp"

namespace groundloop {
namespace {

Eigen::Vector3d seen_from(const PoseGraph& graph, const VerticalFactor& vertical) {
  return graph.vertices[vertical.vertex].pose.rotation.conjugate() * graph.ups[vertical.frame];
}

}  // namespace

Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& up) {
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up).toRotationMatrix();
  return R.leftCols<2>();
}

VerticalFactor vertical_factor(int vertex, int frame, const Eigen::Vector3d& up,
                               const Eigen::Matrix2d& covariance) {
  const Eigen::Matrix2d information = covariance.inverse();
  const Eigen::Matrix2d root =
      Eigen::Matrix2d(0.5 * (information + information.transpose())).llt().matrixU();
  return {vertex, frame, root * across(up).transpose()};
}

Eigen::Vector2d residual_of(const PoseGraph& graph, const VerticalFactor& vertical) {
  return vertical.whitening * seen_from(graph, vertical);
}

// R exp(d) sees the up u as exp(-d) R' u = R' u + [R' u]x d.
Linearised linearise(const PoseGraph& graph, const VerticalFactor& vertical) {
  const Eigen::Vector3d seen = seen_from(graph, vertical);
  const Eigen::Matrix3d R = graph.vertices[vertical.vertex].pose.rotation_matrix();
  Linearised l;
  l.blocks = 2;
  l.block[0].variable = vertical.vertex;
  l.block[0].J.block<2, 3>(0, 3) = vertical.whitening * skew(seen);
  l.block[1].variable = up_variable(graph, vertical.frame);
  l.block[1].J.topLeftCorner<2, 2>() =
      vertical.whitening * R.transpose() * across(graph.ups[vertical.frame]);
  l.residual.head<2>() = vertical.whitening * seen;
  l.information.topLeftCorner<2, 2>() = vertical.weight * Eigen::Matrix2d::Identity();
  return l;
}

double cost(const PoseGraph& graph, const VerticalFactor& vertical) {
  return 0.5 * vertical.weight * residual_of(graph, vertical).squaredNorm();
}

}  // namespace groundloop
