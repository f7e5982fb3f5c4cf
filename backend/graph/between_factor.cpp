#include "backend/graph/between_factor.hpp"

#include "backend/graph/factors.hpp"

namespace groundloop {
namespace {

// With what the recording's bend did to the measurement taken off.
Vector6d residual_of(const PoseGraph& graph, const GraphEdge& edge) {
  Vector6d r = between_residual(graph.vertices[edge.from].pose, graph.vertices[edge.to].pose,
                                edge.T_from_to);
  if (edge.bend >= 0) r += edge.error_by_bend * graph.bends[edge.bend];
  return r;
}

}  // namespace

Vector6d between_residual(const Pose& T_world_from, const Pose& T_world_to, const Pose& T_from_to) {
  return log_se3(T_from_to.inverse() * (T_world_from.inverse() * T_world_to));
}

Vector6d between_residual(const Pose& T_world_from, const Pose& T_world_to, const Pose& T_from_to,
                          Matrix6d& J_from, Matrix6d& J_to) {
  const Pose T_from_to_now = T_world_from.inverse() * T_world_to;
  Vector6d r = log_se3(T_from_to.inverse() * T_from_to_now);
  // T_from exp(d) gives Z^-1 exp(-d) T_from^-1 T_to = (Z^-1 T_from^-1 T_to) exp(-Ad(T_to^-1 T_from)
  // d).
  J_to = right_jacobian_inverse_se3(r);
  J_from.noalias() = -J_to * adjoint(T_from_to_now.inverse());
  return r;
}

Linearised linearise(const PoseGraph& graph, const GraphEdge& edge) {
  Linearised l;
  l.blocks = 2;
  l.block[0].variable = edge.from;
  l.block[1].variable = edge.to;
  l.residual = between_residual(graph.vertices[edge.from].pose, graph.vertices[edge.to].pose,
                                edge.T_from_to, l.block[0].J, l.block[1].J);
  l.information = edge.weight * edge.information;
  if (edge.bend < 0) return l;
  l.residual += edge.error_by_bend * graph.bends[edge.bend];
  l.blocks = 3;
  l.block[2].variable = bend_variable(graph, edge.bend);
  l.block[2].J.leftCols<2>() = edge.error_by_bend;
  return l;
}

double cost(const PoseGraph& graph, const GraphEdge& edge) {
  const Vector6d r = residual_of(graph, edge);
  return 0.5 * edge.weight * r.dot(edge.information * r);
}

double chi2_g2o(const PoseGraph& graph) {
  double sum = 0.0;
  for (const GraphEdge& edge : graph.edges) {
    if (!counts(edge)) continue;
    const Pose error = edge.T_from_to.inverse() *
                       (graph.vertices[edge.from].pose.inverse() * graph.vertices[edge.to].pose);
    Vector6d e;
    e << error.translation, (error.rotation.w() < 0.0 ? -1.0 : 1.0) * error.rotation.vec();
    sum += edge.weight * e.dot(edge.information * e);
  }
  return sum;
}

}  // namespace groundloop
