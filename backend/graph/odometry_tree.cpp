#include "backend/graph/odometry_tree.hpp"

namespace groundloop {

OdometryTree::OdometryTree(const PoseGraph& graph) : nodes_(graph.vertices.size()) {
  std::vector<std::vector<int>> edges_at(nodes_.size());
  PoseGraph odometry;
  odometry.vertices = graph.vertices;
  odometry.edges = graph.edges;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    GraphEdge& edge = odometry.edges[k];
    edge.rejected = edge.rejected || edge.kind == EdgeKind::closure;
    if (edge.rejected) continue;
    edges_at[edge.from].push_back(static_cast<int>(k));
    edges_at[edge.to].push_back(static_cast<int>(k));
  }
  const std::vector<char> roots = gauge(odometry);
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
      const GraphEdge& edge = graph.edges[k];
      const bool forward = edge.from == i;
      Node& node = nodes_[forward ? edge.to : edge.from];
      if (node.root >= 0) continue;
      RelativePose step{edge.T_from_to, covariance_of(edge.information)};
      if (!forward) step = inverse(step);
      node.T_world_vertex = nodes_[i].T_world_vertex * step.T_from_to;
      const Matrix6d carry = adjoint(node.T_world_vertex);
      node.covariance = nodes_[i].covariance + carry * step.covariance * carry.transpose();
      node.parent = i;
      node.root = nodes_[i].root;
      queue.push_back(forward ? edge.to : edge.from);
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
