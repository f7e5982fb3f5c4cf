// A smaller graph of the same solution: runs of odometry whose inner poses meet no other fact
// become one edge each, and are filled in again once the smaller graph is solved. Exact: about the
// values at hand it is the elimination of the inner poses, so that condensing, solving and filling
// in until nothing moves ends where the whole graph's solution is. A recording of 20 000 scans with
// 200 closures becomes a graph of 400 poses.
#pragma once

#include <cstddef>
#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "backend/graph/solver.hpp"

namespace groundloop {

struct CondensedGraph {
  PoseGraph graph;
  std::vector<int> kept;  ///< position in the full graph of each vertex
  /// Position in the full graph of each edge; of a condensed run, its first edge.
  std::vector<std::size_t> edge_of;
  std::vector<std::vector<std::size_t>> runs;  ///< edges of the full graph, of each edge
};

/// Keeps the ends of closures, poses with another fact, fixed ones, those with `keep[i]`, the first
/// of each component, and every pose that does not lie between exactly two odometry edges of
/// invertible information and one recording. Edges that were rejected are left out. Order is kept.
[[nodiscard]] CondensedGraph condense_chains(const PoseGraph& graph,
                                             const std::vector<char>& keep = {});

/// Takes the values of the condensed graph over into `graph`, whose values must still be those that
/// it was condensed about, and moves the poses between to what is likeliest given their ends.
void fill_in(const CondensedGraph& condensed, PoseGraph& graph);

/// Solves the whole graph by way of condensed ones. `held` as for solve(), by vertex of `graph`.
SolveReport solve_condensed(PoseGraph& graph, const std::vector<char>& held,
                            const SolveOptions& options, const Progress& progress = {});

}  // namespace groundloop
