#include "apps/commands/run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include "apps/commands/closing.hpp"
#include "apps/commands/ground_truth.hpp"
#include "apps/commands/progress_bar.hpp"
#include "apps/report/session_documents.hpp"
#include "apps/report/session_report.hpp"
#include "backend/map/map_assembly.hpp"
#include "backend/mapping/checkpoint.hpp"
#include "backend/session/manifest.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/clock.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/recordings/fingerprint.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

// Sends the log to run.log as well, while it lives.
class RunLog {
 public:
  // A session that is resumed goes on with its log. A log that cannot be written costs no session.
  RunLog(const fs::path& file, bool resumed) {
    try {
      sink_ = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string(), !resumed);
    } catch (const spdlog::spdlog_ex& e) {
      throw InputError(file.string() + ": cannot be written; make room, or choose another --out");
    }
    sink_->set_pattern("%Y-%m-%d %H:%M:%S %l: %v");
    spdlog::default_logger()->set_error_handler([](const std::string&) {});
    spdlog::default_logger()->sinks().push_back(sink_);
  }
  ~RunLog() {
    auto& sinks = spdlog::default_logger()->sinks();
    sinks.erase(std::remove(sinks.begin(), sinks.end(), sink_), sinks.end());
  }
  RunLog(const RunLog&) = delete;
  RunLog& operator=(const RunLog&) = delete;

 private:
  spdlog::sink_ptr sink_;
};

// While it lives, what is logged below a warning goes to run.log alone: the terminal gets the same
// figures as a table.
class QuietTerminal {
 public:
  QuietTerminal()
      : terminal_(spdlog::default_logger()->sinks().front()), level_(terminal_->level()) {
    terminal_->set_level(spdlog::level::warn);
  }
  ~QuietTerminal() { terminal_->set_level(level_); }
  QuietTerminal(const QuietTerminal&) = delete;
  QuietTerminal& operator=(const QuietTerminal&) = delete;

 private:
  spdlog::sink_ptr terminal_;
  spdlog::level::level_enum level_;
};

void write_map(const SessionFolder& folder, const SlamResult& result, double voxel_size,
               const Progress& progress) {
  const std::vector<MapPiece> pieces = recording_pieces(
      folder,
      {result.maps, result.odometry, result.solution.trajectory, 0, 0, result.scan_files, 0});
  MapAssemblyOptions options;
  options.voxel_size = voxel_size;
  const std::unique_ptr<PointCloudWriter> writer =
      open_point_cloud_writer(folder.file("map.pcd"), fields_of(pieces, false));
  assemble_map(pieces, options, *writer, folder.path(), progress);
  writer->finish();
}

// Whatever goes wrong with the evaluation, the session is what it is.
std::optional<RunEvaluation> evaluate(const SlamResult& result, const GroundTruth& ground_truth) {
  if (ground_truth.poses.empty()) return std::nullopt;
  try {
    JudgedTruth truth = judge_ground_truth(ground_truth, result.odometry);
    RunEvaluation evaluation;
    log_ground_truth(ground_truth, truth);
    evaluation.odometry = evaluate_trajectory(result.odometry, truth.poses);
    evaluation.optimised = evaluate_trajectory(result.solution.trajectory, truth.poses);
    evaluation.ground_truth = std::move(truth.poses);
    evaluation.frame = truth.frame;
    evaluation.instant_s = truth.instant_s;
    return evaluation;
  } catch (const InputError& e) {
    spdlog::warn("no errors against ground truth: {}", e.what());
    return std::nullopt;
  }
}

void log_summary(const SlamResult& result, const std::optional<RunEvaluation>& evaluation) {
  std::size_t accepted = 0;
  for (const ClosureRecord& c : result.closures)
    accepted += c.status == ClosureStatus::accepted ? 1 : 0;
  spdlog::info("{} scans, {:.0f} m, {} local maps, {} closures accepted of {} candidates",
               result.odometry.size(), path_length(result.solution.trajectory), result.maps.size(),
               accepted, result.closures.size());
  spdlog::info("pose graph: cost {:.6g} before, {:.6g} after, {} iterations ({})",
               result.solution.summary.cost_before, result.solution.summary.cost_after,
               result.solution.summary.iterations, result.solution.summary.termination);
  if (const Levelling& levelling = result.solution.levelling; levelling.applied) {
    spdlog::info(
        "odometry levelled by the walls in {} local maps: bent by {:.2g} +- {:.1g} degrees "
        "a kilometre",
        levelling.maps, levelling.bend * 1000 * 180 / M_PI,
        levelling.bend_deviation * 1000 * 180 / M_PI);
  }
  spdlog::info("odometry errs {:.2g} times as much as stated, as far as the closures tell",
               result.solution.odometry_scale);
  if (evaluation) {
    const auto line = [](const char* name, const TrajectoryEvaluation& e) {
      spdlog::info(
          "{}: APE {:.3f} m rmse after SE(3) alignment ({:.3f} {:.3f} {:.3f} m along x y z), "
          "{:.3f} degrees",
          name, e.ape.translation_m.rmse, e.ape_x_m.rmse, e.ape_y_m.rmse, e.ape_z_m.rmse,
          e.ape.rotation_deg.rmse);
    };
    line("odometry ", evaluation->odometry);
    line("optimised", evaluation->optimised);
  }
  const std::string warning = warning_of(result.trust);
  if (!warning.empty()) spdlog::warn("not to be trusted as a whole: {}", warning);
}

void log_recording(const Recording& recording) {
  const RecordingInfo& info = recording.info();
  spdlog::info("{}: {}, {} scans, {}", info.path, info.format, recording.size(),
               info.sensor.empty() ? "sensor not stated" : info.sensor);
  spdlog::info("stamps: {}; per-point times: {}", info.stamp_source, info.point_times);
  for (const std::string& note : info.notes) spdlog::info("{}", note);
  for (const std::string& warning : info.warnings) spdlog::warn("{}", warning);
}

// Local maps, the map and kept scans are nearly all of a session: 30 to 80, 20
// and 25 to 110 MB a kilometre where 64 beams see a town. The way is not known yet; a scan a metre
// is many, and more of them are not kept.
void check_room(const fs::path& folder, std::size_t scans, bool kept) {
  constexpr double kPerScan = 0.1, kPerKeptScan = 0.07;  // MB
  constexpr double kLeast = 20.0;
  const double per_scan = kPerScan + (kept ? kPerKeptScan : 0.0);
  const double needed = kLeast + per_scan * static_cast<double>(scans);
  const double free = static_cast<double>(free_space(folder)) / 1e6;
  spdlog::info("the session will take up to some {:.0f} MB; {:.0f} MB are free", needed, free);
  if (free < kLeast) {
    throw InputError(folder.string() + ": " + std::to_string(std::lround(free)) +
                     " MB are free, a session takes more; make room or choose another --out");
  }
  if (free < needed) {
    spdlog::warn(
        "the disk may fill up before the end; the session is kept then, and --resume goes on");
  }
}

Manifest manifest_of(const SessionFolder& session, const Recording& recording,
                     const SlamResult& result, const SessionIdentity& identity) {
  Manifest manifest;
  manifest.identity = identity;
  manifest.recording = recording_document(recording.info(), recording.size());
  manifest.sensor = recording.info().sensor;
  manifest.scans = result.odometry.size();
  manifest.local_maps = result.maps.size();
  manifest.scan_files = result.scan_files;
  manifest.checksums = checksums_of(session, manifest.local_maps, manifest.scan_files);
  return manifest;
}

// What comes after the map: errors, documents, and the manifest, which makes the session complete.
// The report takes the figures from metrics.json, and its own time and memory come into that once
// it is written. Returns the figures.
nlohmann::ordered_json finish(SessionOutput& output, const Recording& recording,
                              const RunRequest& request, const GroundTruth& ground_truth,
                              SlamResult& result, Clock::time_point start) {
  const SessionFolder& session = output.folder();
  const std::optional<RunEvaluation> evaluation = evaluate(result, ground_truth);
  const auto write_metrics = [&](const std::optional<ReportCost>& report) {
    result.times.total = result.seconds_before + seconds_since(start);
    nlohmann::ordered_json metrics = metrics_document(result, evaluation, report);
    metrics["recording"] = {{"warnings", recording.info().warnings}};
    write_text_atomically(session.file("metrics.json"), metrics.dump(2) + "\n");
    return metrics;
  };
  const nlohmann::ordered_json before = write_metrics(std::nullopt);
  const Manifest manifest = manifest_of(session, recording, result, output.identity());
  const auto report_start = Clock::now();
  const SessionContents contents =
      read_session_contents(session, SessionFolder(request.out).name(), manifest, request.config);
  write_text_atomically(
      session.file("report.html"),
      make_session_report(contents, {evaluation ? evaluation->ground_truth : Trajectory()}));
  const nlohmann::ordered_json metrics =
      write_metrics(ReportCost{seconds_since(report_start), without_report(before)});
  {
    const QuietTerminal quiet;
    log_summary(result, evaluation);
    spdlog::info(
        "{:.1f} s in all, {:.1f} scans a second, {:.0f} MB peak memory", result.times.total,
        static_cast<double>(result.odometry.size()) / result.times.total, peak_memory_mb());
    spdlog::info("report: {}", (request.out / "report.html").string());
  }
  output.complete(manifest);
  return metrics;
}

}  // namespace

void run_recording(const RunRequest& request, Context& context) {
  const auto start = Clock::now();
  validate_config(request.config);
  RecordingOptions reading = request.reading;
  reading.elevation_correction = request.config.recording.elevation_correction;
  reading.attributes.intensity = request.config.slam.kept_scans.keep;
  const auto opening = Clock::now();
  const std::unique_ptr<Recording> recording = open_any_recording(request.recording, reading);
  const double opening_s = seconds_since(opening);
  const GroundTruth ground_truth =
      request.ground_truth.empty()
          ? own_ground_truth(*recording)
          : read_ground_truth(request.ground_truth, request.truth_frame, *recording);
  const std::string configuration = to_yaml(request.config);
  const SessionIdentity identity{"run", GROUNDLOOP_VERSION, recording_fingerprint(*recording),
                                 hex(checksum(configuration))};
  SessionOutput output(request.out, identity, configuration, {request.overwrite, request.resume});
  if (output.state() == SessionOutput::State::finished) {
    spdlog::info("{}: the session is finished; there is nothing to resume", request.out.string());
    return;
  }
  const SessionFolder& session = output.folder();
  context.after_interruption = "run the same command with --resume to go on";
  try {
    const RunLog log(session.file("run.log"), output.state() == SessionOutput::State::resumed);
    log_recording(*recording);
    check_room(session.path(), recording->size(), request.config.slam.kept_scans.keep);
    stop_on_signals();
    const Progress progress = make_progress(context);
    SlamResult result = run_slam(*recording, request.config.slam, output, progress);
    result.times.read += opening_s;
    const auto map_start = Clock::now();
    if (request.config.map.write)
      write_map(session, result, request.config.map.voxel_size, progress);
    result.times.map = seconds_since(map_start);
    progress("report", 0, 0);
    const nlohmann::ordered_json metrics =
        finish(output, *recording, request, ground_truth, result, start);
    end_progress();
    print_closing_table(metrics, request.out, context);
  } catch (...) {
    end_progress();
    if (!Checkpoint(session, identity).exists()) output.discard();
    throw;
  }
}

}  // namespace groundloop::apps
