// The whole path of one recording: read ahead, odometry, local maps, closures, optimisation, map.
// Reading, odometry and the work on finished maps run at the same time, in threads of their own
// joined by bounded queues; what they compute depends on the order of scans only. Memory holds
// poses, descriptors and a few maps, never the recording.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "backend/mapping/closure_finder.hpp"
#include "backend/mapping/planted_closures.hpp"
#include "backend/mapping/session_solver.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/odometry.hpp"
#include "frontend/recordings/recording.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

[[nodiscard]] inline OptimizerOptions robust_optimizer() {
  OptimizerOptions options;
  options.robust = true;
  return options;
}

struct SlamOptions {
  OdometryOptions odometry;
  LocalMapOptions local_maps;
  LoopClosureOptions loop_closure;
  ClosureOptions closures;
  VerificationOptions verification;
  RegistrationOptions registration;
  LevellingOptions levelling;
  OdometryInformationOptions odometry_information;
  OptimizerOptions pose_graph = robust_optimizer();  ///< closures of a recording are to be judged
  RevisitOptions revisits;
  MapQualityOptions map_quality;
  PlantedClosureOptions planted_closures;
};

/// Busy seconds by stage, and the clock.
struct StageTimes {
  double read = 0, odometry = 0, local_maps = 0, ground_alignment = 0, density_image = 0,
         features = 0, matching = 0, consensus = 0, verification = 0, levelling = 0,
         optimisation = 0, map_quality = 0, map = 0, total = 0;
};

struct SlamResult {
  Trajectory odometry;
  std::size_t predicted_scans = 0;  ///< whose view was blocked
  SessionSolution solution;
  std::vector<LocalMapRecord> maps;  ///< T_world_map optimised
  std::vector<ClosureRecord> closures;
  StageTimes times;
};

/// Runs all stages and writes odometry, trajectories, closures, graph, local maps and loop database
/// to `folder`. With `resume`, goes on from the checkpoint of an interrupted run. Where `progress`
/// throws Interrupted, a checkpoint is written before the exception travels on.
[[nodiscard]] SlamResult run_slam(Recording& recording, const SlamOptions& options,
                                  const SessionFolder& folder, bool resume,
                                  const Progress& progress);

}  // namespace groundloop
