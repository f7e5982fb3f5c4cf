// Which sessions belong together: consistent sets of closures between two frames propose an
// alignment, rival alignments and the ground that overlaps in it decide whether it stands.
#pragma once

#include "backend/merging/joint_problem.hpp"

namespace groundloop {

/// Joins frames until no connection holds. Closures of connections go into the graph as edges and
/// stay `accepted`, as do verified ones beside them that now lie inside a frame: drift may explain
/// why those do not agree pair by pair, and the joint robust solution judges them. Closures of
/// refused connections become `inconsistent`; those found by testing a connection are added.
void connect_sessions(JointProblem& problem, const MergeOptions& options, const Progress& progress);

}  // namespace groundloop
