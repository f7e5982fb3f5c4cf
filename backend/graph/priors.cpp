// A pose known beforehand, such as that of a recording whose map is given, and how large the bend
// of a recording may be.
#include "backend/graph/factors.hpp"

namespace groundloop {
namespace {

Vector6d residual_of(const PoseGraph& graph, const PosePrior& prior) {
  return log_se3(prior.T_world_vertex.inverse() * graph.vertices[prior.vertex].pose);
}

}  // namespace

Linearised linearise(const PoseGraph& graph, const PosePrior& prior) {
  Linearised l;
  l.blocks = 1;
  l.residual = residual_of(graph, prior);
  l.block[0].variable = prior.vertex;
  l.block[0].J = right_jacobian_inverse_se3(l.residual);
  l.information = prior.information;
  return l;
}

double cost(const PoseGraph& graph, const PosePrior& prior) {
  const Vector6d r = residual_of(graph, prior);
  return 0.5 * r.dot(prior.information * r);
}

Linearised linearise(const PoseGraph& graph, const BendPrior& prior) {
  Linearised l;
  l.blocks = 1;
  l.residual.head<2>() = graph.bends[prior.bend];
  l.block[0].variable = bend_variable(graph, prior.bend);
  l.block[0].J.topLeftCorner<2, 2>().setIdentity();
  l.information.topLeftCorner<2, 2>() = prior.deviation.cwiseAbs2().cwiseInverse().asDiagonal();
  return l;
}

double cost(const PoseGraph& graph, const BendPrior& prior) {
  return 0.5 * graph.bends[prior.bend].cwiseQuotient(prior.deviation).squaredNorm();
}

}  // namespace groundloop
