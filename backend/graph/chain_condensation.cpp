#include "backend/graph/chain_condensation.hpp"

#include <array>
#include <numeric>

#include <Eigen/Cholesky>

#include "backend/graph/relative_pose.hpp"

namespace groundloop {
namespace {

constexpr int kNone = -1;

// Odometry edges at each vertex: two are remembered, more only counted.
struct Joint {
  std::array<int, 2> edge = {kNone, kNone};
  int count = 0;
};

class Condenser {
 public:
  Condenser(const PoseGraph& graph, const std::vector<EdgeEnds>& ends)
      : graph_(graph), ends_(ends), joints_(graph.vertices.size()) {
    keep_.assign(graph.vertices.size(), 0);
    used_.assign(graph.edges.size(), 0);
    const std::vector<int> component = connected_components(graph, ends);
    int next_component = 0;
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      const bool first = component[i] == next_component;
      if (first) ++next_component;
      keep_[i] = first || graph.vertices[i].fixed;
    }
    root_.resize(graph.vertices.size());
    std::iota(root_.begin(), root_.end(), 0);
    for (std::size_t k = 0; k < graph.edges.size(); ++k) note_edge(static_cast<int>(k));
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      if (joints_[i].count != 2) keep_[i] = 1;
    }
  }

  CondensedGraph run() {
    CondensedGraph result;
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      if (!keep_[i]) continue;
      result.kept.push_back(static_cast<int>(i));
      result.graph.vertices.push_back(graph_.vertices[i]);
    }
    for (std::size_t k = 0; k < graph_.edges.size(); ++k) {
      if (graph_.edges[k].rejected || used_[k]) continue;
      const auto [from, to] = ends_[k];
      if (keep_[from] && keep_[to]) {
        result.graph.edges.push_back(graph_.edges[k]);
        result.edge_of.push_back(k);
      } else if (keep_[from] || keep_[to]) {
        result.graph.edges.push_back(walk(keep_[from] ? from : to, static_cast<int>(k)));
        result.edge_of.push_back(k);
      }
    }
    return result;
  }

 private:
  void note_edge(int k) {
    const GraphEdge& edge = graph_.edges[k];
    if (edge.rejected) return;
    bool joins = edge.kind == EdgeKind::odometry && edge.weight == 1.0 &&
                 edge.information.llt().info() == Eigen::Success;
    // An edge that closes a ring of trusted edges keeps its ends: a run round the ring would end
    // where it began.
    joins = joins && join_roots(ends_[k].from, ends_[k].to);
    for (const int vertex : {ends_[k].from, ends_[k].to}) {
      if (!joins) keep_[vertex] = 1;
      Joint& joint = joints_[vertex];
      if (joint.count < 2) joint.edge[joint.count] = k;
      ++joint.count;
    }
  }

  // False where the two were joined before.
  bool join_roots(int a, int b) {
    while (root_[a] != a) a = root_[a] = root_[root_[a]];
    while (root_[b] != b) b = root_[b] = root_[root_[b]];
    root_[b] = a;
    return a != b;
  }

  // The edge from the kept vertex `start` through edge `k` and on to the next kept vertex.
  GraphEdge walk(int start, int k) {
    GraphEdge result;
    RelativePose chain;
    int vertex = start;
    for (;;) {
      const GraphEdge& edge = graph_.edges[k];
      used_[k] = 1;
      const RelativePose step{edge.T_from_to, edge.information.llt().solve(Matrix6d::Identity())};
      const bool forward = ends_[k].from == vertex;
      chain = chain * (forward ? step : inverse(step));
      vertex = forward ? ends_[k].to : ends_[k].from;
      if (keep_[vertex]) break;
      const Joint& joint = joints_[vertex];
      k = joint.edge[0] == k ? joint.edge[1] : joint.edge[0];
    }
    result.from = graph_.vertices[start].id;
    result.to = graph_.vertices[vertex].id;
    result.T_from_to = chain.T_from_to;
    const Matrix6d information = chain.covariance.llt().solve(Matrix6d::Identity());
    result.information = 0.5 * (information + information.transpose());
    return result;
  }

  const PoseGraph& graph_;
  const std::vector<EdgeEnds>& ends_;
  std::vector<Joint> joints_;
  std::vector<char> keep_;
  std::vector<char> used_;
  std::vector<int> root_;  // of the trees that trusted edges form
};

}  // namespace

CondensedGraph condense_chains(const PoseGraph& graph, const std::vector<EdgeEnds>& ends) {
  return Condenser(graph, ends).run();
}

}  // namespace groundloop
