// The first stage of a run: every scan through odometry into local maps and closures, with
// checkpoints on the way.
#pragma once

#include "backend/mapping/checkpoint.hpp"
#include "backend/mapping/run_state.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop {

/// Registers the scans that are left, and finishes the last local map. `state.scans_finished` is
/// set and a last checkpoint written when it returns. `seconds` of clock pass between checkpoints.
/// Throws what reading, odometry, writing and `progress` throw; after Interrupted, and after
/// InputError of reading or odometry once a map is finished, the checkpoint holds all that was
/// done.
void process_scans(Recording& recording, RunState& state, const Checkpoint& checkpoint,
                   double seconds, const Progress& progress);

}  // namespace groundloop
