// Relative poses between vertices of a solved pose graph with the covariance of the shortest chain
// of edges between them, closures included: how well a session knows its own shape. It bounds the
// covariance of the solution from above, at the price of a shortest-path search.
#pragma once

#include <map>
#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "backend/graph/relative_pose.hpp"

namespace groundloop {

class GraphChains {
 public:
  /// Searches from each of `sources` (positions of vertices) over the edges that are not rejected.
  GraphChains(const PoseGraph& graph, const std::vector<int>& sources);

  /// Pose of `to` in `from`, which must be a source. Throws std::logic_error where no chain joins
  /// the two.
  [[nodiscard]] RelativePose between(int from, int to) const;
  [[nodiscard]] bool joined(int from, int to) const;

 private:
  struct Reach {
    RelativePose pose;
    bool reached = false;
  };
  std::map<int, std::vector<Reach>> from_;
};

}  // namespace groundloop
