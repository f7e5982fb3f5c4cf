// pose_graph.g2o of a session. Its edges are odometry first, then one for each accepted row of
// closures.csv, in the rows' order: which edge is what is written, and closures that were given up
// are no edges.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// Vertices of an accepted closure.
struct ClosureEnds {
  int query = 0;
  int reference = 0;
};

/// Ids must be positions; closures, settled ones too, must stand in the order of their rows.
void write_session_graph(const std::filesystem::path& file, const PoseGraph& graph);

/// The graph with the kind of every edge. Throws InputError where vertices are not the session's
/// `maps` in order, or the last edges not those of the accepted closures.
[[nodiscard]] PoseGraph read_session_graph(const std::filesystem::path& file, std::size_t maps,
                                           const std::vector<ClosureEnds>& accepted);

}  // namespace groundloop
