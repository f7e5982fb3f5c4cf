#include "backend/mapping/scan_processing.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "backend/mapping/mapping_thread.hpp"
#include "frontend/core/clock.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/unreadable_file.hpp"
#include "frontend/recordings/read_ahead.hpp"

namespace groundloop {
namespace {

std::string scan_name(const Recording& recording, std::size_t index) {
  return recording.info().path + ": scan " + std::to_string(index);
}

class ScanProcessing {
 public:
  ScanProcessing(Recording& recording, RunState& state, const Checkpoint& checkpoint,
                 double seconds)
      : recording_(recording),
        state_(state),
        before_(state.times),
        checkpoint_(checkpoint),
        interval_(seconds),
        mapping_(state.builder, state.finder, state.keeper),
        reader_(recording, state.trajectory.size(), recording.size() - state.trajectory.size()) {}

  void run(const Progress& progress) {
    try {
      while (true) {
        if (progress) progress("odometry", state_.trajectory.size(), recording_.size());
        const std::optional<Scan> scan = next();
        if (!scan) break;
        add(*scan);
        if (seconds_since(saved_) >= interval_) save();
      }
    } catch (const Interrupted&) {
      save();
      throw;
    } catch (const InputError&) {
      // A file that is not handed out, far into a recording: once it is, --resume goes on from
      // here. An error of the mapping thread is worse, and travels instead.
      mapping_.drain();
      if (!state_.finder.maps().empty()) save();
      throw;
    }
    if (!state_.odometry.started()) {
      if (!first_fault_.empty()) throw InputError(first_fault_);
      throw InputError(recording_.info().path + ": none of " + std::to_string(recording_.size()) +
                       " scans has enough points within range to be registered; check the sensor, "
                       "odometry.min_range, odometry.max_range and odometry.min_points");
    }
    mapping_.finish();
    if (const std::optional<LocalMap> last = state_.builder.finish()) state_.finder.add(*last);
    state_.keeper.finish();
    state_.scans_finished = true;
    count_times();
    checkpoint_.save(state_);
  }

 private:
  // The next scan; without points where it cannot be used: its pose is predicted.
  std::optional<Scan> next() {
    try {
      return reader_.next();
    } catch (const UnreadableFile&) {
      throw;
    } catch (const InputError& error) {
      const std::size_t index = state_.trajectory.size();
      constexpr std::uint64_t kNamed = 20;  // the report counts all
      if (state_.unusable_scans++ < kNamed)
        spdlog::warn("scan {} cannot be used, its pose is predicted: {}", index, error.what());
      if (first_fault_.empty()) first_fault_ = error.what();
      Scan scan;
      scan.stamp = recording_.stamp(index);
      return scan;
    }
  }

  void add(const Scan& scan) {
    RegisteredScan registered =
        state_.odometry.add(scan, scan_name(recording_, state_.trajectory.size()));
    odometry_seconds_ += registered.seconds;
    state_.trajectory.push_back({scan.stamp, registered.T_world_scan});
    state_.quality.push_back(registered.quality);
    std::vector<float> intensity;
    if (state_.keeper.keeps() && !registered.points.empty())
      intensity = state_.odometry.within_range(scan, scan.attributes.intensity);
    mapping_.add(std::move(registered.points), std::move(intensity), registered.T_world_scan,
                 breaks(registered.quality.doubt));
  }

  // With every scan so far in its map, so that the state is one of between two scans.
  void save() {
    mapping_.drain();
    count_times();
    const auto start = Clock::now();
    checkpoint_.save(state_);
    constexpr double kShare = 20.0;
    interval_ = std::max(interval_, kShare * seconds_since(start));
    saved_ = Clock::now();
  }

  void count_times() {
    const LoopClosureTimes& t = state_.finder.times();
    StageTimes& times = state_.times;
    times = before_;
    times.read += reader_.seconds_reading();
    times.odometry += odometry_seconds_;
    times.local_maps += mapping_.building_seconds();
    times.keeping += mapping_.keeping_seconds();
    times.ground_alignment += t.ground_alignment;
    times.density_image += t.density_image;
    times.features += t.features;
    times.matching += t.matching;
    times.consensus += t.consensus;
    times.squares.ground_alignment += t.squares.ground_alignment;
    times.squares.detection += t.squares.detection;
    times.squares.consensus += t.squares.consensus;
    times.verification += state_.finder.verification_seconds();
    times.total += seconds_since(start_);
  }

  Recording& recording_;
  RunState& state_;
  StageTimes before_;
  const Checkpoint& checkpoint_;
  double interval_;
  Clock::time_point start_ = Clock::now(), saved_ = start_;
  double odometry_seconds_ = 0.0;
  std::string first_fault_;  // of a scan that cannot be used
  MappingThread mapping_;
  ReadAhead reader_;
};

// Where one of the first two scans cannot be used, odometry starts at rest.
void start(Recording& recording, Odometry& odometry) {
  try {
    const Scan first = recording.read(0);
    odometry.start(first, recording.read(1));
  } catch (const UnreadableFile&) {
    throw;
  } catch (const InputError&) {
    return;  // it is said in its turn
  }
}

}  // namespace

void process_scans(Recording& recording, RunState& state, const Checkpoint& checkpoint,
                   double seconds, const Progress& progress) {
  if (state.scans_finished) return;
  if (state.trajectory.empty() && recording.size() > 1) start(recording, state.odometry);
  ScanProcessing(recording, state, checkpoint, seconds).run(progress);
}

}  // namespace groundloop
