#include "apps/commands/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include "apps/commands/progress_bar.hpp"
#include "apps/report/run_report.hpp"
#include "apps/report/session_documents.hpp"
#include "backend/map/map_assembly.hpp"
#include "backend/mapping/checkpoint.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

// The folder a run writes to. Refuses one that holds something else, and clears what an earlier run
// left.
class RunFolder {
 public:
  RunFolder(const fs::path& path, bool resume) : session_(path), existed_(fs::exists(path)) {
    std::error_code error;
    if (existed_ && !fs::is_directory(path))
      throw InputError(path.string() + ": is no folder; choose another --out");
    if (existed_ && !resume && !fs::is_empty(path, error) &&
        !fs::exists(session_.file("manifest.json")) && !Checkpoint(session_).exists()) {
      throw InputError(path.string() + ": holds files that are no session; choose another --out");
    }
    fs::create_directories(path / "local_maps", error);
    if (error)
      throw InputError(path.string() + ": cannot be written: " + error.message() +
                       "; choose another --out");
    write_text_atomically(session_.file("run.log"), "");
    if (!resume) clear();
  }
  [[nodiscard]] const SessionFolder& session() const { return session_; }

  /// After a failure before anything worth keeping was made.
  void discard() const {
    if (Checkpoint(session_).exists()) return;
    std::error_code error;
    if (!existed_) {
      fs::remove_all(session_.path(), error);
    } else {
      clear();
      fs::remove(session_.file("run.log"), error);
      fs::remove(session_.path() / "local_maps", error);
    }
  }

 private:
  void clear() const {
    std::error_code error;
    for (const char* name : {"manifest.json", "config.yaml", "odometry.tum", "trajectory.tum",
                             "trajectory.kitti", "closures.csv", "pose_graph.g2o", "local_maps.csv",
                             "loop_database.bin", "map.pcd", "metrics.json", "report.html"}) {
      fs::remove(session_.file(name), error);
    }
    Checkpoint(session_).remove();
    for (const fs::path& file : list_files(session_.path() / "local_maps", ".pcd"))
      fs::remove(file, error);
  }

  SessionFolder session_;
  bool existed_;
};

// Sends the log to run.log as well, while it lives.
class RunLog {
 public:
  explicit RunLog(const fs::path& file)
      : sink_(std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string(), true)) {
    sink_->set_pattern("%Y-%m-%d %H:%M:%S %l: %v");
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

void write_map(const SessionFolder& folder, const SlamResult& result, double voxel_size,
               const Progress& progress) {
  std::vector<MapPiece> pieces;
  for (const LocalMapRecord& map : result.maps)
    pieces.push_back(
        bent_piece(folder.local_map(map.map), map, result.odometry, result.solution.trajectory));
  MapAssemblyOptions options;
  options.voxel_size = voxel_size;
  const std::unique_ptr<PointCloudWriter> writer =
      open_point_cloud_writer(folder.file("map.pcd"), false);
  assemble_map(pieces, options, *writer, folder.path(), progress);
  writer->finish();
}

std::optional<RunEvaluation> evaluate(const SlamResult& result, const Trajectory& ground_truth) {
  if (ground_truth.empty()) return std::nullopt;
  return RunEvaluation{evaluate_trajectory(result.odometry, ground_truth),
                       evaluate_trajectory(result.solution.trajectory, ground_truth)};
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
  spdlog::info("{:.1f} s in all, {:.1f} scans a second, {:.0f} MB peak memory", result.times.total,
               static_cast<double>(result.odometry.size()) / result.times.total, peak_memory_mb());
}

}  // namespace

Trajectory read_ground_truth(const fs::path& file, const Recording& recording) {
  const std::string text = read_text(file);
  std::size_t columns = 0;
  std::size_t line_start = 0;
  while (line_start < text.size() && columns == 0) {
    const std::size_t end = std::min(text.find('\n', line_start), text.size());
    bool inside = false;
    if (text[line_start] != '#') {
      for (std::size_t i = line_start; i < end; ++i) {
        const bool space = text[i] == ' ' || text[i] == '\t' || text[i] == '\r';
        columns += !space && !inside ? 1 : 0;
        inside = !space;
      }
    }
    line_start = end + 1;
  }
  if (columns == 8) return read_tum(file);
  if (columns != 12) {
    throw InputError(file.string() + ": " + std::to_string(columns) +
                     " columns; 8 are TUM, 12 are KITTI");
  }
  const std::vector<Pose> poses = read_kitti_poses(file);
  if (poses.size() != recording.size()) {
    throw InputError(file.string() + ": " + std::to_string(poses.size()) + " poses for " +
                     std::to_string(recording.size()) +
                     " scans; KITTI ground truth has one row a scan");
  }
  Trajectory trajectory;
  for (std::size_t i = 0; i < poses.size(); ++i)
    trajectory.push_back({recording.stamp(i), poses[i]});
  return trajectory;
}

void run_recording(const RunRequest& request, const Context& context) {
  const auto start = std::chrono::steady_clock::now();
  validate_config(request.config);
  RecordingOptions reading = request.reading;
  reading.elevation_correction = request.config.recording.elevation_correction;
  const std::unique_ptr<Recording> recording = open_any_recording(request.recording, reading);
  const Trajectory ground_truth = request.ground_truth.empty()
                                      ? recording->ground_truth()
                                      : read_ground_truth(request.ground_truth, *recording);
  const RunFolder folder(request.out, request.resume);
  const SessionFolder& session = folder.session();
  const RunLog log(session.file("run.log"));
  const RecordingInfo& info = recording->info();
  spdlog::info("{}: {}, {} scans, {}", info.path, info.format, recording->size(),
               info.sensor.empty() ? "sensor not stated" : info.sensor);
  spdlog::info("stamps: {}; per-point times: {}", info.stamp_source, info.point_times);
  for (const std::string& note : info.notes) spdlog::info("{}", note);

  stop_on_signals();
  const Progress progress = make_progress(context);
  SlamResult result;
  try {
    write_text_atomically(session.file("config.yaml"), to_yaml(request.config));
    result = run_slam(*recording, request.config.slam, session, request.resume, progress);
    const auto map_start = std::chrono::steady_clock::now();
    if (request.config.map.write)
      write_map(session, result, request.config.map.voxel_size, progress);
    result.times.map =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - map_start).count();
  } catch (...) {
    end_progress();
    folder.discard();
    throw;
  }
  end_progress();
  result.times.total =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const std::optional<RunEvaluation> evaluation = evaluate(result, ground_truth);
  write_text_atomically(session.file("metrics.json"),
                        metrics_document(result, evaluation).dump(2) + "\n");
  write_text_atomically(session.file("manifest.json"),
                        manifest_document(session, *recording, result, "complete").dump(2) + "\n");
  write_text_atomically(
      session.file("report.html"),
      make_run_report(*recording, request.config, result, ground_truth, evaluation, session));
  log_summary(result, evaluation);
  spdlog::info("report: {}", session.file("report.html").string());
}

}  // namespace groundloop::apps
