#include "backend/mapping/slam.hpp"

#include <chrono>

#include "backend/graph/g2o_file.hpp"
#include "backend/mapping/checkpoint.hpp"
#include "backend/mapping/mapping_thread.hpp"
#include "frontend/core/error.hpp"
#include "frontend/recordings/read_ahead.hpp"

namespace groundloop {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Everything that grows while scans come in.
struct State {
  State(const SlamOptions& options, const SessionFolder& folder)
      : odometry(options.odometry),
        builder(options.local_maps),
        finder(folder, options.loop_closure, options.closures, options.verification,
               options.registration) {}
  Odometry odometry;
  LocalMapBuilder builder;
  ClosureFinder finder;
  Trajectory trajectory;
};

std::string scan_name(const Recording& recording, std::size_t index) {
  return recording.info().path + ": scan " + std::to_string(index);
}

// Registers all scans that are left. Returns busy seconds by stage.
StageTimes process_scans(Recording& recording, State& state, const Progress& progress) {
  StageTimes times;
  const std::size_t total = recording.size();
  if (state.trajectory.empty() && total > 1)
    state.odometry.start(recording.read(0), recording.read(1));
  MappingThread mapping(state.builder, state.finder);
  ReadAhead reader(recording, state.trajectory.size(), total - state.trajectory.size());
  while (true) {
    if (progress) progress("odometry", state.trajectory.size(), total);
    std::optional<Scan> scan = reader.next();
    if (!scan) break;
    RegisteredScan registered =
        state.odometry.add(*scan, scan_name(recording, state.trajectory.size()));
    times.odometry += registered.seconds;
    state.trajectory.push_back({scan->stamp, registered.T_world_scan});
    mapping.add(std::move(registered.points), registered.T_world_scan);
  }
  mapping.finish();
  times.local_maps = mapping.building_seconds();
  times.read = reader.seconds_reading();
  return times;
}

void add_closure_times(const ClosureFinder& finder, StageTimes& times) {
  const LoopClosureTimes& t = finder.times();
  times.ground_alignment += t.ground_alignment;
  times.density_image += t.density_image;
  times.features += t.features;
  times.matching += t.matching;
  times.consensus += t.consensus;
  times.verification += finder.verification_seconds();
}

void write_results(const SessionFolder& folder, const SlamResult& result,
                   const ClosureFinder& finder) {
  write_tum(folder.file("odometry.tum"), result.odometry);
  write_tum(folder.file("trajectory.tum"), result.solution.trajectory);
  write_kitti_poses(folder.file("trajectory.kitti"), result.solution.trajectory);
  write_closures(folder.file("closures.csv"), result.closures);
  write_local_maps(folder.file("local_maps.csv"), result.maps);
  write_g2o(folder.file("pose_graph.g2o"), result.solution.key_graph);
  finder.database().save(folder.file("loop_database.bin"));
}

}  // namespace

SlamResult run_slam(Recording& recording, const SlamOptions& options, const SessionFolder& folder,
                    bool resume, const Progress& progress) {
  const auto start = Clock::now();
  State state(options, folder);
  Checkpoint checkpoint(folder);
  if (resume)
    checkpoint.load(state.odometry, state.builder, state.finder, state.trajectory,
                    options.loop_closure);
  SlamResult result;
  try {
    result.times = process_scans(recording, state, progress);
  } catch (const Interrupted&) {
    checkpoint.save(state.odometry, state.builder, state.finder, state.trajectory);
    throw;
  } catch (const InputError&) {
    // A scan that cannot be used, far into a recording: once it is mended, --resume goes on from
    // here.
    if (!state.finder.maps().empty()) {
      checkpoint.save(state.odometry, state.builder, state.finder, state.trajectory);
    }
    throw;
  }
  if (std::optional<LocalMap> last = state.builder.finish()) state.finder.add(*last);
  add_closure_times(state.finder, result.times);

  result.odometry = std::move(state.trajectory);
  result.predicted_scans = state.odometry.predicted_scans();
  result.closures = state.finder.closures();
  result.maps = state.finder.maps();
  plant_false_closures(options.planted_closures, result.odometry, result.maps, result.closures);
  const SolverInput input{
      result.odometry,      options.levelling,    options.odometry_information,
      options.pose_graph,   options.revisits,     options.map_quality,
      options.verification, options.registration, options.closures.pairwise_consistency};
  result.solution =
      solve_session(input, result.maps, state.finder.store(), result.closures, progress);
  result.times.levelling = result.solution.levelling_seconds;
  result.times.optimisation = result.solution.optimisation_seconds;
  result.times.verification += result.solution.verification_seconds;
  result.times.map_quality = result.solution.map_quality.seconds;
  for (std::size_t m = 0; m < result.maps.size(); ++m)
    result.maps[m].T_world_map = result.solution.T_world_map[m];
  write_results(folder, result, state.finder);
  checkpoint.remove();
  result.times.total = seconds_since(start);
  return result;
}

}  // namespace groundloop
