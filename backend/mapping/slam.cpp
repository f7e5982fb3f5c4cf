#include "backend/mapping/slam.hpp"

#include <spdlog/spdlog.h>

#include "backend/graph/marginals.hpp"
#include "backend/mapping/odometry_table.hpp"
#include "backend/mapping/scan_processing.hpp"
#include "backend/session/session_graph.hpp"
#include "backend/session/uncertainty_table.hpp"
#include "frontend/core/clock.hpp"

namespace groundloop {
namespace {

void write_results(const SessionFolder& folder, const SlamResult& result,
                   const ClosureFinder& finder) {
  write_tum(folder.file("odometry.tum"), result.odometry);
  write_odometry_quality(folder.file("odometry_quality.csv"), result.quality);
  write_tum(folder.file("trajectory.tum"), result.solution.trajectory);
  write_kitti_poses(folder.file("trajectory.kitti"), result.solution.trajectory);
  write_closures(folder.file("closures.csv"), result.closures);
  write_local_maps(folder.file("local_maps.csv"), result.maps);
  write_session_graph(folder.file("pose_graph.g2o"), result.solution.key_graph);
  if (const auto covariances = pose_covariances(result.solution.key_graph)) {
    write_uncertainty(folder.file("uncertainty.csv"), *covariances);
  } else {
    spdlog::warn("uncertainty.csv is not written: the pose graph leaves a pose open");
  }
  finder.database().save(folder.file("loop_database.bin"));
}

void log_trust(const OdometryTrust& trust) {
  const std::string warning = warning_of(trust);
  if (!warning.empty()) spdlog::warn("{}", warning);
  spdlog::info("odometry: {} scans good, {} weak, {} lost, {} predicted",
               trust.count(OdometryState::good), trust.count(OdometryState::weak),
               trust.count(OdometryState::lost), trust.count(OdometryState::predicted));
}

}  // namespace

SlamResult run_slam(Recording& recording, const SlamOptions& options, SessionOutput& output,
                    const Progress& progress) {
  const auto start = Clock::now();
  const SessionFolder& folder = output.folder();
  RunState state{Odometry(options.odometry),
                 LocalMapBuilder(options.local_maps),
                 ClosureFinder(folder, options.loop_closure, options.closures, options.verification,
                               options.registration),
                 ScanKeeper(folder, options.kept_scans),
                 {},
                 {},
                 0,
                 {}};
  const Checkpoint checkpoint(folder, output.identity());
  if (output.state() == SessionOutput::State::resumed && checkpoint.exists())
    checkpoint.load(state, options.loop_closure);
  SlamResult result;
  result.seconds_before = state.times.total;
  process_scans(recording, state, checkpoint, options.keeping.checkpoint_seconds, progress);
  output.reached(SessionStage::odometry);

  result.times = state.times;
  result.odometry = std::move(state.trajectory);
  result.quality = std::move(state.quality);
  result.trust = trust_of(result.quality, result.odometry);
  log_trust(result.trust);
  result.unusable_scans = state.unusable_scans;
  result.predicted_scans = state.odometry.predicted_scans();
  result.closures = state.finder.closures();
  result.maps = state.finder.maps();
  result.scan_files = state.keeper.files();
  const SolverInput input{result.odometry,
                          options.levelling,
                          options.odometry_information,
                          options.pose_graph,
                          options.revisits,
                          options.map_quality,
                          options.verification,
                          options.registration,
                          options.closures.pairwise_consistency,
                          loose_steps(result.quality, result.odometry)};
  result.solution =
      solve_session(input, result.maps, state.finder.store(), result.closures, progress);
  result.times.levelling = result.solution.levelling_seconds;
  result.times.optimisation = result.solution.optimisation_seconds;
  result.times.verification += result.solution.verification_seconds;
  result.times.map_quality = result.solution.map_quality.seconds;
  for (std::size_t m = 0; m < result.maps.size(); ++m)
    result.maps[m].T_world_map = result.solution.T_world_map[m];
  write_results(folder, result, state.finder);
  result.times.total = result.seconds_before + seconds_since(start);
  return result;
}

}  // namespace groundloop
