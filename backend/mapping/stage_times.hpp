// Busy seconds by stage of a run, and the clock.
#pragma once

#include "loopclosure/loop_closure.hpp"

namespace groundloop {

struct StageTimes {
  double read = 0, odometry = 0, local_maps = 0, keeping = 0, ground_alignment = 0,
         density_image = 0, features = 0, matching = 0, consensus = 0, verification = 0,
         levelling = 0, optimisation = 0, map_quality = 0, map = 0, total = 0;
  /// Of the seconds a local map takes, over the local maps.
  LoopClosureTimes::Squares squares;
};

}  // namespace groundloop
