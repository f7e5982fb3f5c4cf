// Reading and writing SE(3) pose graphs in g2o's text format: VERTEX_SE3:QUAT, EDGE_SE3:QUAT and
// FIX. Other tags are counted, not understood; the planar and landmark types of g2o are among them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

struct G2oFile {
  PoseGraph graph;  ///< ids and order as in the file; kinds by successive ids
  std::map<std::string, std::size_t> unknown_tags;  ///< lines skipped, by tag
};

/// Reads `file`. Throws InputError naming the file and the line where a line is broken, an id is
/// repeated, an edge or FIX names a vertex that is nowhere in the file, or information is not
/// positive semi-definite. Quaternions are normalised. Vertices may follow the edges that use them.
[[nodiscard]] G2oFile read_g2o(const std::filesystem::path& file);

/// Writes the graph atomically: vertices, FIX lines, then edges, ids and order kept, every number
/// so that it reads back the same. Weights are not part of the format; rejected edges are left out
/// where `with_rejected` is false.
void write_g2o(const std::filesystem::path& file, const PoseGraph& graph,
               bool with_rejected = true);

}  // namespace groundloop
