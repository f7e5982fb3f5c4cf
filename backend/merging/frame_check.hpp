// Frames by what the accepted closures join in the end: the joint robust solution may have cut a
// connection, and whoever is still joined stays together, the one that named the frame or not.
#pragma once

#include <vector>

#include "backend/merging/joint_problem.hpp"

namespace groundloop {

/// Recordings of a frame that fell apart get frames by component: the part with the recording that
/// named the frame keeps it; every other is named by its first recording, in whose own world it
/// then lies. A part that is what the input had goes back to where and how it was.
/// `frames_before` and `before` are the input's.
void check_frames(JointProblem& problem, const std::vector<int>& frames_before,
                  const PoseGraph& before);

}  // namespace groundloop
