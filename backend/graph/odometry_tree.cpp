#include "backend/graph/odometry_tree.hpp"

#include <Eigen/Cholesky>

#include "backend/graph/gauge.hpp"

namespace groundloop {

OdometryTree::OdometryTree(const PoseGraph& graph, const std::vector<EdgeEnds>& ends)
    : nodes_(graph.vertices.size()) {
  std::vector<std::vector<int>> edges_at(nodes_.size());
  PoseGraph odometry = graph;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    GraphEdge& edge = odometry.edges[k];
    edge.rejected = edge.rejected || edge.kind == EdgeKind::closure;
    if (edge.rejected) continue;
    edges_at[ends[k].from].push_back(static_cast<int>(k));
    edges_at[ends[k].to].push_back(static_cast<int>(k));
  }
  const std::vector<char> roots = gauge(odometry, connected_components(odometry, ends));
  std::vector<int> queue;
  for (int i = 0; i < static_cast<int>(nodes_.size()); ++i) {
    if (!roots[i]) continue;
    nodes_[i].T_world_vertex = graph.vertices[i].pose;
    nodes_[i].root = i;
    queue.push_back(i);
  }
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const int i = queue[head];
    for (const int k : edges_at[i]) {
      const bool forward = ends[k].from == i;
      Node& node = nodes_[forward ? ends[k].to : ends[k].from];
      if (node.root >= 0) continue;
      const GraphEdge& edge = graph.edges[k];
      const Eigen::LLT<Matrix6d> llt(edge.information);
      RelativePose step{edge.T_from_to, Matrix6d::Zero()};
      if (llt.info() == Eigen::Success) step.covariance = llt.solve(Matrix6d::Identity());
      if (!forward) step = inverse(step);
      node.T_world_vertex = nodes_[i].T_world_vertex * step.T_from_to;
      const Matrix6d carry = adjoint(node.T_world_vertex);
      node.covariance = nodes_[i].covariance + carry * step.covariance * carry.transpose();
      node.parent = i;
      node.root = nodes_[i].root;
      queue.push_back(forward ? ends[k].to : ends[k].from);
    }
  }
  for (std::size_t i = queue.size(); i-- > 0;) {
    const Node& node = nodes_[queue[i]];
    if (node.parent >= 0) nodes_[node.parent].size += node.size;
  }
  std::vector<int> next(nodes_.size(), 0);  // free place in preorder below a vertex
  for (const int i : queue) {
    Node& node = nodes_[i];
    if (node.parent >= 0) {
      node.enter = next[node.parent];
      next[node.parent] += node.size;
    }
    next[i] = node.enter + 1;
  }
}

bool OdometryTree::is_above(int a, int b) const {
  return nodes_[a].root == nodes_[b].root && nodes_[a].enter <= nodes_[b].enter &&
         nodes_[b].enter < nodes_[a].enter + nodes_[a].size;
}

RelativePose OdometryTree::between(int from, int to) const {
  const Node& a = nodes_[from];
  const Node& b = nodes_[to];
  const Pose T_from_to = a.T_world_vertex.inverse() * b.T_world_vertex;
  if (a.root != b.root) return {T_from_to, 1e12 * Matrix6d::Identity()};
  int top = is_above(to, from) ? to : from;
  while (!is_above(top, to)) top = nodes_[top].parent;
  // Steps are independent, and in the world frame they add.
  const Matrix6d sum = a.covariance + b.covariance - 2.0 * nodes_[top].covariance;
  const Matrix6d carry = adjoint(b.T_world_vertex.inverse());
  return {T_from_to, carry * sum * carry.transpose()};
}

}  // namespace groundloop
