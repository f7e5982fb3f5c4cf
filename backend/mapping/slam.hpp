// The whole path of one recording: read ahead, odometry, local maps, closures, optimisation, map.
// Reading, odometry and the work on finished maps run at the same time, in threads of their own
// joined by bounded queues; what they compute depends on the order of scans only. Memory holds
// poses, descriptors and a few maps, never the recording.
#pragma once

#include <vector>

#include "backend/mapping/closure_finder.hpp"
#include "backend/mapping/odometry_trust.hpp"
#include "backend/mapping/scan_keeper.hpp"
#include "backend/mapping/session_solver.hpp"
#include "backend/mapping/stage_times.hpp"
#include "backend/session/session_output.hpp"
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

/// How a session is kept while it is made.
struct KeepingOptions {
  double checkpoint_seconds = 20.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("checkpoint_seconds", self.checkpoint_seconds, Range{0.0, 3600.0}, "s",
          "clock between two checkpoints while scans come in: what a killed run repeats, at most; "
          "longer apart where writing one takes more than a twentieth of the time");
  }
};

struct SlamOptions {
  KeepingOptions keeping;
  KeptScanOptions kept_scans;
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
};

struct SlamResult {
  Trajectory odometry;
  std::vector<ScanQuality> quality;  ///< of odometry, one a scan
  OdometryTrust trust;
  std::size_t predicted_scans = 0;  ///< of few points, a blocked view, or not to be read
  std::size_t unusable_scans = 0;   ///< of these, those that could not be read
  SessionSolution solution;
  std::vector<LocalMapRecord> maps;  ///< T_world_map optimised
  std::size_t scan_files = 0;        ///< of kept scans
  std::vector<ClosureRecord> closures;
  StageTimes times;
  double seconds_before = 0.0;  ///< of clock, in earlier calls that a resumed session goes on from
};

/// Runs all stages and writes odometry, trajectories, closures, graph, local maps and loop database
/// to the output's folder. Goes on from the checkpoint of a resumed session. Checkpoints are
/// written while scans come in, once all are registered, and before an exception travels on that
/// leaves something to resume: Interrupted, thrown by `progress`, and InputError of a scan that
/// cannot be used.
[[nodiscard]] SlamResult run_slam(Recording& recording, const SlamOptions& options,
                                  SessionOutput& output, const Progress& progress);

}  // namespace groundloop
