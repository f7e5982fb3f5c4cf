#include "backend/graph/pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

constexpr double kSemiDefiniteTolerance = 1e-9;

bool is_finite(const Pose& pose) {
  return pose.rotation.coeffs().allFinite() && pose.translation.allFinite();
}

std::string name_of(const GraphEdge& edge, std::size_t index) {
  return "pose graph: edge " + std::to_string(index) + " (" + std::to_string(edge.from) + " to " +
         std::to_string(edge.to) + ")";
}

std::unordered_map<int, int> index_by_id(const PoseGraph& graph) {
  std::unordered_map<int, int> index;
  index.reserve(graph.vertices.size());
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    if (!index.emplace(graph.vertices[i].id, static_cast<int>(i)).second) {
      throw InputError("pose graph: vertex " + std::to_string(graph.vertices[i].id) +
                       " occurs twice; give every vertex its own id");
    }
  }
  return index;
}

int find_vertex(const std::unordered_map<int, int>& index, int id, const GraphEdge& edge,
                std::size_t edge_index) {
  const auto found = index.find(id);
  if (found == index.end()) {
    throw InputError(name_of(edge, edge_index) + " names vertex " + std::to_string(id) +
                     ", which the graph does not have; add the vertex or leave the edge out");
  }
  return found->second;
}

int root_of(std::vector<int>& parent, int i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

template <typename F>
double sum_over_edges(const PoseGraph& graph, F&& term) {
  const std::vector<EdgeEnds> ends = resolve_edges(graph);
  double sum = 0.0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (edge.rejected) continue;
    sum += edge.weight *
           term(edge, graph.vertices[ends[k].from].pose, graph.vertices[ends[k].to].pose);
  }
  return sum;
}

}  // namespace

std::string defect_of(const GraphEdge& edge) {
  if (edge.from == edge.to) return "joins a vertex with itself";
  if (!is_finite(edge.T_from_to)) return "has a pose that is not finite";
  if (!edge.information.allFinite()) return "has information that is not finite";
  if (!std::isfinite(edge.weight) || edge.weight < 0.0) return "has a negative weight";
  const double scale = edge.information.cwiseAbs().maxCoeff();
  if ((edge.information - edge.information.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale) {
    return "has information that is not symmetric";
  }
  if (edge.information.llt().info() == Eigen::Success) return "";
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(edge.information, Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues().minCoeff() < -kSemiDefiniteTolerance * scale) {
    return "has information that is not positive semi-definite";
  }
  return "";
}

std::vector<EdgeEnds> resolve_edges(const PoseGraph& graph) {
  const std::unordered_map<int, int> index = index_by_id(graph);
  for (const GraphVertex& vertex : graph.vertices) {
    if (!is_finite(vertex.pose)) {
      throw InputError("pose graph: the pose of vertex " + std::to_string(vertex.id) +
                       " is not finite");
    }
  }
  std::vector<EdgeEnds> ends(graph.edges.size());
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    const std::string defect = defect_of(edge);
    if (!defect.empty()) throw InputError(name_of(edge, k) + " " + defect);
    ends[k].from = find_vertex(index, edge.from, edge, k);
    ends[k].to = find_vertex(index, edge.to, edge, k);
  }
  return ends;
}

std::vector<int> connected_components(const PoseGraph& graph, const std::vector<EdgeEnds>& ends) {
  const int n = static_cast<int>(graph.vertices.size());
  std::vector<int> parent(n);
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (graph.edges[k].rejected) continue;
    const int a = root_of(parent, ends[k].from);
    const int b = root_of(parent, ends[k].to);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::vector<int> component(n);
  int count = 0;
  // The root of a component is its first vertex, so it is numbered before the others.
  for (int i = 0; i < n; ++i) {
    const int root = root_of(parent, i);
    component[i] = root == i ? count++ : component[root];
  }
  return component;
}

void classify_edges_by_successive_ids(PoseGraph& graph) {
  std::vector<int> ids;
  ids.reserve(graph.vertices.size());
  for (const GraphVertex& vertex : graph.vertices) ids.push_back(vertex.id);
  std::sort(ids.begin(), ids.end());
  for (GraphEdge& edge : graph.edges) {
    const auto next = std::upper_bound(ids.begin(), ids.end(), std::min(edge.from, edge.to));
    const bool successive = next != ids.end() && *next == std::max(edge.from, edge.to);
    edge.kind = successive ? EdgeKind::odometry : EdgeKind::closure;
  }
}

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

Matrix6d whitening(const Matrix6d& information) {
  const Eigen::LLT<Matrix6d> llt(information);
  if (llt.info() == Eigen::Success) return llt.matrixU();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

double cost(const PoseGraph& graph) {
  return 0.5 * sum_over_edges(graph, [](const GraphEdge& edge, const Pose& from, const Pose& to) {
           const Vector6d r = between_residual(from, to, edge.T_from_to);
           return r.dot(edge.information * r);
         });
}

double chi2_g2o(const PoseGraph& graph) {
  return sum_over_edges(graph, [](const GraphEdge& edge, const Pose& from, const Pose& to) {
    const Pose error = edge.T_from_to.inverse() * (from.inverse() * to);
    Vector6d e;
    e << error.translation, (error.rotation.w() < 0.0 ? -1.0 : 1.0) * error.rotation.vec();
    return e.dot(edge.information * e);
  });
}

}  // namespace groundloop
