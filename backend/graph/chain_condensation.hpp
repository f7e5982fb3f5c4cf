// A smaller graph for questions about closures: runs of odometry whose inner vertices meet no
// closure become one edge each, the composed measurement with the composed covariance (first
// order). A recording of 20 000 scans with 200 closures becomes a graph of 400 vertices.
#pragma once

#include <cstddef>
#include <vector>

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

struct CondensedGraph {
  PoseGraph graph;
  std::vector<int> kept;  ///< position in the full graph of each vertex
  /// Position in the full graph of each edge; of a condensed run, its first edge.
  std::vector<std::size_t> edge_of;
};

/// Keeps the ends of closures, fixed vertices, the first vertex of each component, and every vertex
/// that does not lie between exactly two odometry edges of invertible information. Edges that were
/// rejected are left out. Order is kept.
[[nodiscard]] CondensedGraph condense_chains(const PoseGraph& graph,
                                             const std::vector<EdgeEnds>& ends);

}  // namespace groundloop
