#include "backend/graph/pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "frontend/core/error.hpp"
#include "frontend/core/union_find.hpp"

namespace groundloop {
namespace {

constexpr double kSemiDefiniteTolerance = 1e-9;

bool is_finite(const Pose& pose) {
  return pose.rotation.coeffs().allFinite() && pose.translation.allFinite();
}

std::string name_of(const PoseGraph& graph, std::size_t k) {
  const auto id = [&](int vertex) {
    const bool known = vertex >= 0 && vertex < static_cast<int>(graph.vertices.size());
    return known ? std::to_string(graph.vertices[vertex].id) : std::string("none");
  };
  return "pose graph: edge " + std::to_string(k) + " (" + id(graph.edges[k].from) + " to " +
         id(graph.edges[k].to) + ")";
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

void check_graph(const PoseGraph& graph) {
  for (const GraphVertex& vertex : graph.vertices) {
    if (!is_finite(vertex.pose)) {
      throw InputError("pose graph: the pose of vertex " + std::to_string(vertex.id) +
                       " is not finite");
    }
  }
  const auto n = static_cast<int>(graph.vertices.size());
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    const bool inside = std::min(edge.from, edge.to) >= 0 && std::max(edge.from, edge.to) < n;
    const std::string defect = inside ? defect_of(edge) : "leaves the graph";
    if (!defect.empty()) throw InputError(name_of(graph, k) + " " + defect);
  }
}

std::vector<int> connected_components(const PoseGraph& graph) {
  UnionFind sets(graph.vertices.size());
  for (const GraphEdge& edge : graph.edges) {
    if (!edge.rejected) sets.join(edge.from, edge.to);
  }
  return sets.numbered();
}

std::vector<char> gauge(const PoseGraph& graph) {
  const std::vector<int> component = connected_components(graph);
  std::vector<char> fixed(graph.vertices.size());
  std::vector<char> anchored(graph.vertices.size(), 0);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    fixed[i] = graph.vertices[i].fixed;
    if (fixed[i]) anchored[component[i]] = 1;
  }
  for (const PosePrior& prior : graph.priors) anchored[component[prior.vertex]] = 1;
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (!std::exchange(anchored[component[i]], 1)) fixed[i] = 1;
  }
  return fixed;
}

void classify_edges_by_successive_ids(PoseGraph& graph) {
  std::vector<int> ids;
  ids.reserve(graph.vertices.size());
  for (const GraphVertex& vertex : graph.vertices) ids.push_back(vertex.id);
  std::vector<int> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  for (GraphEdge& edge : graph.edges) {
    const auto [low, high] = std::minmax(ids[edge.from], ids[edge.to]);
    const auto next = std::upper_bound(sorted.begin(), sorted.end(), low);
    const bool successive = next != sorted.end() && *next == high;
    edge.kind = successive ? EdgeKind::odometry : EdgeKind::closure;
  }
}

}  // namespace groundloop
