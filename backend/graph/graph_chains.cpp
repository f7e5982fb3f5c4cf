#include "backend/graph/graph_chains.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// Variance of a point this far away says which of two chains is shorter.
constexpr double kLeverArm = 50.0;

struct Arc {
  int to;
  RelativePose pose;
  double length;
};

std::vector<std::vector<Arc>> arcs_of(const PoseGraph& graph) {
  std::vector<std::vector<Arc>> arcs(graph.vertices.size());
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const GraphEdge& edge = graph.edges[k];
    if (edge.rejected) continue;
    const int from = edge.from;
    const int to = edge.to;
    // A trace of information keeps singular directions finite.
    const Matrix6d regular = edge.information + 1e-6 * Matrix6d::Identity();
    const RelativePose there{graph.vertices[from].pose.inverse() * graph.vertices[to].pose,
                             regular.inverse()};
    const double length =
        there.covariance.topLeftCorner<3, 3>().trace() +
        kLeverArm * kLeverArm * there.covariance.bottomRightCorner<3, 3>().trace();
    arcs[from].push_back({to, there, length});
    arcs[to].push_back({from, inverse(there), length});
  }
  return arcs;
}

}  // namespace

GraphChains::GraphChains(const PoseGraph& graph, const std::vector<int>& sources) {
  const std::vector<std::vector<Arc>> arcs = arcs_of(graph);
  for (const int source : sources) from_[source];
  std::vector<std::pair<const int, std::vector<Reach>>*> searches;
  for (auto& search : from_) searches.push_back(&search);
  parallel_for(searches.size(), 1, [&](std::size_t s) {
    const int source = searches[s]->first;
    std::vector<Reach>& reach = searches[s]->second;
    reach.resize(arcs.size());
    std::vector<double> length(arcs.size(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    length[source] = 0.0;
    reach[source].reached = true;
    queue.emplace(0.0, source);
    while (!queue.empty()) {
      const auto [distance, i] = queue.top();
      queue.pop();
      if (distance > length[i]) continue;
      for (const Arc& arc : arcs[i]) {
        const double along = distance + arc.length;
        if (along >= length[arc.to]) continue;
        length[arc.to] = along;
        reach[arc.to] = {reach[i].pose * arc.pose, true};
        queue.emplace(along, arc.to);
      }
    }
  });
}

bool GraphChains::joined(int from, int to) const { return from_.at(from)[to].reached; }

RelativePose GraphChains::between(int from, int to) const {
  const Reach& reach = from_.at(from)[to];
  check(reach.reached, "a chain of edges joins the two vertices");
  return reach.pose;
}

}  // namespace groundloop
