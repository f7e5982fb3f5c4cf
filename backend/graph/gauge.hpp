// The gauge of a pose graph: which vertices a solver holds.
#pragma once

#include <vector>

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// 1 for each vertex to hold: those marked fixed, and the first of each component that has none.
[[nodiscard]] std::vector<char> gauge(const PoseGraph& graph, const std::vector<int>& component);

}  // namespace groundloop
