#include "apps/commands/merge.hpp"

#include <algorithm>
#include <map>

#include <spdlog/spdlog.h>

#include "apps/commands/closing.hpp"
#include "apps/commands/detection.hpp"
#include "apps/commands/ground_truth.hpp"
#include "apps/commands/progress_bar.hpp"
#include "apps/report/merge_documents.hpp"
#include "apps/report/report_cost.hpp"
#include "apps/report/session_report.hpp"
#include "backend/graph/marginals.hpp"
#include "backend/map/map_assembly.hpp"
#include "backend/session/session_graph.hpp"
#include "backend/session/session_output.hpp"
#include "backend/session/uncertainty_table.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/clock.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

MergeOptions merge_options(const Config& config) {
  const SlamOptions& slam = config.slam;
  MergeOptions options;
  options.odometry_information = config.slam.odometry_information;
  options.matching = {slam.loop_closure, slam.closures, slam.verification, slam.registration};
  options.connection = config.connection;
  options.optimizer = slam.pose_graph;
  options.revisits = slam.revisits;
  return options;
}

bool same_folder(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error);
}

// The output must not be one of the inputs.
void check_out(const MergeRequest& request) {
  for (const fs::path& session : request.sessions) {
    if (same_folder(session, request.out)) {
      throw InputError(request.out.string() +
                       ": is one of the sessions to merge; choose another --out");
    }
  }
}

// What the merge is made of: every session as its manifest says, what holds, and given matches.
SessionIdentity identity_of(const MergeRequest& request, const std::string& configuration) {
  Checksum input;
  for (const fs::path& session : request.sessions) {
    const SessionFolder folder(session);
    input.add(folder.name()).add_value(has_manifest(folder));
    if (has_manifest(folder)) input.add_value(checksum_of_file(folder.file("manifest.json")));
  }
  input.add(request.fixed);
  for (const fs::path& file : request.matches) {
    std::error_code error;
    if (fs::is_regular_file(file, error)) input.add_value(checksum_of_file(file));
  }
  return {"merge", GROUNDLOOP_VERSION, hex(input.value()), hex(checksum(configuration))};
}

std::vector<StoredSession> load_sessions(const MergeRequest& request,
                                         std::vector<ManifestLeftOut>& left_out) {
  std::vector<StoredSession> sessions;
  for (std::size_t i = 0; i < request.sessions.size(); ++i) {
    const fs::path& path = request.sessions[i];
    for (std::size_t j = 0; j < i; ++j) {
      if (same_folder(path, request.sessions[j]))
        throw InputError(path.string() + ": named twice; a session is merged once");
    }
    try {
      sessions.push_back(load_session(path, request.config.slam.loop_closure));
    } catch (const InputError& e) {
      spdlog::warn("session '{}' is left out: {}", SessionFolder(path).name(), e.what());
      left_out.push_back({path.string(), e.what()});
    }
  }
  if (sessions.size() < 2) {
    throw InputError(std::to_string(sessions.size()) + " usable session" +
                     (sessions.size() == 1 ? "" : "s") + " of " +
                     std::to_string(request.sessions.size()) + "; a merge needs two" +
                     (left_out.empty() ? "" : "; first fault: " + left_out.front().reason));
  }
  return sessions;
}

std::optional<std::size_t> fixed_session(const MergeRequest& request,
                                         const std::vector<StoredSession>& sessions) {
  if (request.fixed.empty()) return std::nullopt;
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    if (sessions[s].folder.name() == request.fixed ||
        same_folder(sessions[s].folder.path(), request.fixed))
      return s;
  }
  throw InputError("--fix " + request.fixed + ": is none of the sessions that can be used");
}

std::vector<PairMatches> load_matches(const std::vector<fs::path>& files) {
  std::vector<PairMatches> all;
  for (const fs::path& file : files) {
    try {
      for (PairMatches& pair : read_matches(file)) all.push_back(std::move(pair));
    } catch (const InputError& e) {
      spdlog::warn("{}; its sessions are matched anew", e.what());
    }
  }
  return all;
}

// Matches are kept in an unfinished merge, a file a pair, so that a resumed one need not find them
// again.
class KeptMatches {
 public:
  explicit KeptMatches(const SessionFolder& out) : folder_(out.path() / "matches") {}

  [[nodiscard]] std::vector<PairMatches> load() {
    if (!fs::is_directory(folder_)) return {};
    const std::vector<fs::path> files = list_files(folder_, ".csv");
    next_ = files.size();
    return load_matches(files);
  }
  void keep(const PairMatches& matches) {
    write_matches(folder_ / (std::to_string(next_++) + ".csv"), {matches});
  }

 private:
  fs::path folder_;
  std::size_t next_ = 0;
};

// Of every recording, read before the work begins. Throws InputError where a file that was named
// cannot be used.
std::map<std::string, GroundTruth> read_ground_truths(const MergeRequest& request,
                                                      const std::vector<StoredSession>& sessions) {
  std::map<std::string, GroundTruth> truths;
  for (const StoredSession& session : sessions) {
    for (const SessionPart& part : session.parts) {
      const auto file = request.ground_truth.find(part.name);
      truths[part.name] =
          ground_truth_of(part, file == request.ground_truth.end() ? fs::path() : file->second, "");
    }
  }
  for (const auto& [name, file] : request.ground_truth) {
    if (truths.count(name) == 0)
      throw InputError("--ground-truth " + name + "=...: no such session");
  }
  return truths;
}

// Maps and scans keep their files: linked where the disk allows it, else copied.
void bring_files(const SessionFolder& out, const MergeResult& result,
                 const std::vector<StoredSession>& sessions) {
  for (const MergedPart& part : result.parts) {
    for (const LocalMapRecord& map : part.maps) {
      const fs::path from =
          sessions[part.session].folder.local_map(part.source->first_map + map.map);
      const fs::path to = out.local_map(part.first_map + map.map);
      link_or_copy(from, to);
    }
    for (std::size_t n = 0; n < part.source->scan_files; ++n) {
      link_or_copy(sessions[part.session].folder.scan_file(part.source->first_scan_file + n),
                   out.scan_file(part.first_scan_file + n));
    }
  }
  sync_folder(out.path() / "local_maps");
  if (fs::exists(out.path() / "scans")) sync_folder(out.path() / "scans");
}

void write_map(const SessionFolder& out, const MergeResult& result, const MapSection& options,
               const Progress& progress) {
  std::vector<MapPiece> pieces;
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    const MergedPart& part = result.parts[p];
    if (part.frame != result.parts.front().frame) continue;
    const std::vector<MapPiece> own = recording_pieces(
        out, {part.maps, part.odometry, part.trajectory, part.first_map, part.first_scan_file,
              part.source->scan_files, static_cast<std::uint16_t>(p)});
    pieces.insert(pieces.end(), own.begin(), own.end());
  }
  const auto writer = open_point_cloud_writer(out.file("map.pcd"), fields_of(pieces, true));
  MapAssemblyOptions assembly;
  assembly.voxel_size = options.voxel_size;
  assemble_map(pieces, assembly, *writer, out.path(), progress);
  writer->finish();
}

void write_trajectories(const SessionFolder& folder, const Trajectory& odometry,
                        const Trajectory& trajectory, const std::vector<LocalMapRecord>& maps) {
  write_tum(folder.file("odometry.tum"), odometry);
  write_tum(folder.file("trajectory.tum"), trajectory);
  write_kitti_poses(folder.file("trajectory.kitti"), trajectory);
  write_local_maps(folder.file("local_maps.csv"), maps);
}

// Tables of each recording and of the whole, where maps and scans are numbered through.
void write_tables(const SessionFolder& out, const MergeResult& result,
                  const LoopClosureOptions& options) {
  Trajectory odometry;
  Trajectory trajectory;
  std::vector<LocalMapRecord> maps;
  LoopDatabase database(options);
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    const MergedPart& part = result.parts[p];
    const SessionFolder own(out.path() / "sessions" / part.source->name);
    fs::create_directories(own.path());
    write_trajectories(own, part.odometry, part.trajectory, part.maps);
    odometry.insert(odometry.end(), part.odometry.begin(), part.odometry.end());
    trajectory.insert(trajectory.end(), part.trajectory.begin(), part.trajectory.end());
    for (LocalMapRecord map : part.maps) {
      map.map += part.first_map;
      map.first_scan += part.first_scan;
      map.last_scan += part.first_scan;
      maps.push_back(map);
    }
    for (MapDescription description : part.source->descriptions) {
      description.key.session = static_cast<int>(p);
      database.insert(std::move(description));
    }
  }
  write_trajectories(out, odometry, trajectory, maps);
  write_closures(out.file("closures.csv"), result.closures);
  write_session_graph(out.file("pose_graph.g2o"), result.graph);
  if (const auto covariances = pose_covariances(result.graph)) {
    write_uncertainty(out.file("uncertainty.csv"), *covariances);
  } else {
    spdlog::warn("uncertainty.csv is not written: the pose graph leaves a pose open");
  }
  database.save(out.file("loop_database.bin"));
}

// Ground truth of every part, as poses of its sensor.
std::vector<Trajectory> judged_truths(const MergeResult& result,
                                      const std::map<std::string, GroundTruth>& truths) {
  std::vector<Trajectory> judged;
  for (const MergedPart& part : result.parts) {
    const GroundTruth& truth = truths.at(part.source->name);
    judged.emplace_back();
    if (truth.poses.empty()) continue;
    JudgedTruth of_part = judge_ground_truth(truth, part.odometry);
    log_ground_truth(truth, of_part);
    judged.back() = std::move(of_part.poses);
  }
  return judged;
}

std::string log_text(const MergeResult& result, const std::vector<ManifestLeftOut>& left_out) {
  std::string log;
  for (const std::string& note : result.notes) log += note + "\n";
  for (const ManifestLeftOut& l : left_out) log += "left out: " + l.input + ": " + l.reason + "\n";
  return log;
}

void warn_of_parts_apart(const MergeResult& result) {
  for (const MergedPart& part : result.parts) {
    if (part.frame == result.parts.front().frame) continue;
    spdlog::warn(
        "'{}' is not connected to '{}': its poses are in the frame of '{}', and map.pcd does not "
        "hold it",
        part.source->name, result.parts.front().source->name,
        result.parts[part.frame].source->name);
  }
}

void log_evaluation(const MergeResult& result, const MergeEvaluation& evaluation) {
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    if (!evaluation.optimised[p]) continue;
    spdlog::info("'{}': APE {:.3f} m rmse after SE(3) alignment, {:.3f} m by odometry",
                 result.parts[p].source->name, evaluation.optimised[p]->ape.translation_m.rmse,
                 evaluation.odometry[p]->ape.translation_m.rmse);
    if (evaluation.by_reference[p]) {
      spdlog::info("'{}': APE {:.3f} m rmse by the alignment of '{}'", result.parts[p].source->name,
                   evaluation.by_reference[p]->ape.translation_m.rmse,
                   result.parts[result.parts[p].frame].source->name);
    }
  }
  if (evaluation.joint) {
    spdlog::info("all sessions of the first frame with one alignment: APE {:.3f} m rmse",
                 evaluation.joint->ape.translation_m.rmse);
  }
}

}  // namespace

void merge_recordings(const MergeRequest& request, Context& context) {
  const auto start = Clock::now();
  validate_config(request.config);
  check_out(request);
  const std::string configuration = to_yaml(request.config);
  const SessionIdentity identity = identity_of(request, configuration);
  std::vector<ManifestLeftOut> left_out;
  const std::vector<StoredSession> sessions = load_sessions(request, left_out);
  const std::optional<std::size_t> fixed = fixed_session(request, sessions);
  std::vector<PairMatches> matches = load_matches(request.matches);
  const std::map<std::string, GroundTruth> truths = read_ground_truths(request, sessions);
  SessionOutput output(request.out, identity, configuration, {request.overwrite, request.resume});
  if (output.state() == SessionOutput::State::finished) {
    spdlog::info("{}: the merge is finished; there is nothing to resume", request.out.string());
    return;
  }
  const SessionFolder& out = output.folder();
  context.after_interruption = "run the same command with --resume to go on";
  stop_on_signals();
  const Progress progress = make_progress(context);
  MergeOptions options = merge_options(request.config);
  KeptMatches kept(out);
  for (PairMatches& pair : kept.load()) matches.push_back(std::move(pair));
  options.on_matched = [&](const PairMatches& pair) { kept.keep(pair); };
  try {
    const MergeResult result = merge_sessions(sessions, matches, fixed, options, progress);
    bring_files(out, result, sessions);
    write_tables(out, result, request.config.slam.loop_closure);
    const auto map_start = Clock::now();
    if (request.config.map.write) write_map(out, result, request.config.map, progress);
    const double map_seconds = seconds_since(map_start);
    end_progress();
    const MergeEvaluation evaluation = evaluate_merge(result, judged_truths(result, truths));
    write_text_atomically(out.file("run.log"), log_text(result, left_out));
    // Written again after the report, with what that took.
    const auto write_metrics = [&](const std::optional<ReportCost>& report) {
      nlohmann::ordered_json metrics =
          merge_metrics(result, evaluation, map_seconds, seconds_since(start));
      add_report_cost(metrics, report);
      write_text_atomically(out.file("metrics.json"), metrics.dump(2) + "\n");
      return metrics;
    };
    const nlohmann::ordered_json before = write_metrics(std::nullopt);
    Manifest manifest = merge_manifest(out, result, sessions, left_out);
    manifest.identity = identity;
    progress("report", 0, 0);
    const auto report_start = Clock::now();
    const SessionContents contents =
        read_session_contents(out, SessionFolder(request.out).name(), manifest, request.config);
    write_text_atomically(out.file("report.html"),
                          make_session_report(contents, evaluation.ground_truth));
    const nlohmann::ordered_json metrics =
        write_metrics(ReportCost{seconds_since(report_start), without_report(before)});
    output.complete(manifest);
    end_progress();
    warn_of_parts_apart(result);
    log_evaluation(result, evaluation);
    print_closing_table(metrics, request.out, context);
  } catch (...) {
    end_progress();
    // Matches are what a merge takes its time for.
    if (!fs::exists(out.path() / "matches")) output.discard();
    throw;
  }
}

void match_recordings(const MatchRequest& request, const Context& context) {
  validate_config(request.config);
  const LoopClosureOptions& loop_closure = request.config.slam.loop_closure;
  const SessionMatchingOptions options = merge_options(request.config).matching;
  stop_on_signals();
  const Progress progress = make_progress(context);
  StoredSession reference = load_session(request.reference, loop_closure);
  MapStore references(reference.folder, options.registration);
  if (request.anew) describe_anew(reference, loop_closure, progress);
  if (request.query.empty()) {
    const std::vector<ClosureRecord> closures =
        match_within(reference, references, options, progress);
    end_progress();
    write_closures(request.out, closures);
    spdlog::info("{}: {} candidates", request.out.string(), closures.size());
    return;
  }
  StoredSession query = load_session(request.query, loop_closure);
  MapStore queries(query.folder, options.registration);
  if (request.anew) describe_anew(query, loop_closure, progress);
  std::vector<PairMatches> pairs;
  for (const SessionPart& r : reference.parts) {
    for (const SessionPart& q : query.parts) {
      if (r.name == q.name) {
        throw InputError("both sessions hold a recording called '" + r.name +
                         "'; rename one of the folders");
      }
      pairs.push_back(match_parts(r, references, q, queries, options, nullptr, progress));
    }
  }
  end_progress();
  std::size_t candidates = 0;
  std::size_t verified = 0;
  for (const PairMatches& pair : pairs) {
    candidates += pair.closures.size();
    for (const ClosureRecord& c : pair.closures)
      verified += c.status == ClosureStatus::accepted ? 1 : 0;
  }
  write_matches(request.out, pairs);
  spdlog::info("{}: {} candidates, {} verified", request.out.string(), candidates, verified);
}

}  // namespace groundloop::apps
