// Chordal initialisation of a pose graph (Martinec and Pajdla, CVPR 2007; Carlone et al., ICRA
// 2015): rotations from a linear least-squares problem over matrices that need not be rotations,
// projected onto SO(3), then translations from a second linear problem. It needs no guess and comes
// close enough to the optimum for a local solver to find it on graphs of moderate noise. Edges are
// the only facts it asks.
#pragma once

#include <vector>

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// Replaces every pose but those with `held[i]`, of which each connected component needs one.
/// Rejected edges are left out, weights count. Returns false, the graph untouched, where a linear
/// system is singular, as with information that constrains no rotation.
[[nodiscard]] bool initialise_chordal(PoseGraph& graph, const std::vector<char>& held);

}  // namespace groundloop
