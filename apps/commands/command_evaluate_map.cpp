// `groundloop evaluate map SESSION [--truth MAP]`: how sharp a map is, on its own, against the same
// scans at true poses, and against a true map.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "apps/commands/commands.hpp"
#include "apps/commands/ground_truth.hpp"
#include "apps/commands/progress_bar.hpp"
#include "apps/commands/session_pieces.hpp"
#include "backend/evaluation/map_comparison.hpp"
#include "backend/evaluation/map_measures.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/session/manifest.hpp"
#include "frontend/core/error.hpp"
#include "frontend/recordings/point_cloud_file.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string session, truth, ground_truth, truth_frame;
  double cell = 1.0, limit = 1.0, voxel = 3.0;
  bool json = false;
};

// Where there is room for the session; else, where it may not be written, where there is any.
fs::path scratch_folder(const SessionFolder& session) {
  const bool writable = ::access(session.path().c_str(), W_OK) == 0;
  return writable ? session.path() : fs::temp_directory_path();
}

MapMeasures measure(const std::vector<MapPiece>& pieces, const SessionFolder& session,
                    double cell) {
  // A whole number of cells, so that none lies in two tiles.
  PointTiles tiles(scratch_folder(session), 50.0 * cell);
  std::uint32_t offset = 0, last = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    // Recordings do not follow one another.
    if (p > 0 && pieces[p].session != pieces[p - 1].session) offset = last + 2;
    std::vector<WorldPoint> points = points_in_world(pieces[p]);
    for (WorldPoint& point : points) {
      point.tag += offset;
      last = std::max(last, point.tag);
    }
    tiles.add(points);
  }
  return measure_map(tiles, cell);
}

Json to_json(const ThicknessFigures& f) {
  return {{"mean_m", f.mean_m}, {"p95_m", f.most_m}, {"cells", f.cells}};
}

Json to_json(const MapMeasures& m) {
  return {{"plane_thickness", to_json(m.planes)},
          {"plane_thickness_at_revisits", to_json(m.revisited)},
          {"mean_map_entropy", m.entropy},
          {"judged_share", m.judged_share},
          {"points", m.points},
          {"cell_m", m.cell_m}};
}

Json to_json(const MapComparison& c) {
  return {{"accuracy_m", c.accuracy_m},
          {"mean_distance_m", c.mean_distance_m},
          {"matched_share", c.matched_share},
          {"completeness", c.completeness},
          {"chamfer_m", c.chamfer_m},
          {"average_wasserstein_m", c.wasserstein_m},
          {"wasserstein_voxels", c.voxels},
          {"limit_m", c.limit_m},
          {"voxel_m", c.voxel_m}};
}

// True poses of the scans of a session of one recording, where they are known for all of them.
struct TruePoses {
  Trajectory trajectory;  // at the scans
  Pose T_truth_world;     // aligned over positions
};

std::optional<TruePoses> true_poses(const Arguments& arguments, const SessionFolder& session) {
  const Manifest manifest = read_complete_manifest(session);
  if (manifest.merged()) return std::nullopt;
  const auto recording = open_any_recording(manifest.recording.at("path").get<std::string>());
  const GroundTruth truth =
      arguments.ground_truth.empty()
          ? own_ground_truth(*recording)
          : read_ground_truth(arguments.ground_truth, arguments.truth_frame, *recording);
  if (truth.poses.empty()) return std::nullopt;
  const JudgedTruth judged = judge_ground_truth(truth, read_tum(session.file("odometry.tum")));
  log_ground_truth(truth, judged);
  const Trajectory estimate = read_tum(session.file("trajectory.tum"));
  const TrajectoryEvaluation evaluation = evaluate_trajectory(estimate, judged.poses);
  if (evaluation.pairs.size() != estimate.size()) {
    spdlog::warn("{} of {} scans have no true pose: the map at true poses is left out",
                 estimate.size() - evaluation.pairs.size(), estimate.size());
    return std::nullopt;
  }
  TruePoses result;
  result.T_truth_world = evaluation.alignment.pose;
  for (const auto& [scan, row] : evaluation.pairs)
    result.trajectory.push_back({estimate[scan].stamp, judged.poses[row].pose});
  return result;
}

// Without a reachable recording, or a truth that can be used, the map stands for itself.
std::optional<TruePoses> true_poses_if_any(const Arguments& arguments,
                                           const SessionFolder& session) {
  try {
    return true_poses(arguments, session);
  } catch (const InputError& e) {
    if (!arguments.ground_truth.empty()) throw;
    spdlog::info("no map at true poses: {}", e.what());
    return std::nullopt;
  }
}

// The points of the map, one a voxel.
class MapPoints : public PointCloudWriter {
 public:
  void write(std::span<const ExportPoint> points) override {
    for (const ExportPoint& point : points) all.push_back(point.position.cast<float>());
    count_ = all.size();
  }
  void finish() override {}
  Points all;
};

Points map_points(const std::vector<MapPiece>& pieces, const SessionFolder& session) {
  MapPoints map;
  assemble_map(pieces, {}, map, scratch_folder(session));
  return std::move(map.all);
}

// A true map may lie in the session's world, or in that of its ground truth: the guess from which
// more of it matches.
Json compare(const Arguments& arguments, const SessionFolder& session,
             const std::vector<MapPiece>& pieces, const std::vector<Pose>& guesses) {
  const Points truth = read_point_cloud(arguments.truth);
  const Points map = map_points(pieces, session);
  std::optional<MapComparison> best;
  for (const Pose& guess : guesses) {
    const PoseF T(align_maps(map, truth, guess, arguments.limit));
    Points moved = map;
    for (Eigen::Vector3f& p : moved) p = T * p;
    const MapComparison comparison = compare_maps(moved, truth, arguments.limit, arguments.voxel);
    if (!best || comparison.matched_share > best->matched_share) best = comparison;
  }
  Json json = to_json(*best);
  json["aligned_by"] = "point-to-point ICP within the limit";
  return json;
}

void print_row(const char* name, const ThicknessFigures& f) {
  std::printf("  %-28s %8.4f m mean %8.4f m for 95 %% %9zu cells\n", name, f.mean_m, f.most_m,
              f.cells);
}

void print_measures(const char* title, const MapMeasures& m) {
  std::printf("%s (%zu points, cells of %g m)\n", title, m.points, m.cell_m);
  print_row("thickness of planes", m.planes);
  print_row("where visited again", m.revisited);
  std::printf("  %-28s %8.4f\n  %-28s %8.3f\n", "mean map entropy", m.entropy,
              "share of cells that are planes", m.judged_share);
}

void run(const Arguments& arguments, Context& context) {
  const SessionFolder session{fs::path(arguments.session)};
  const SessionPieces pieces = pieces_of(session);
  stop_on_signals();
  const MapMeasures own = measure(pieces.pieces, session, arguments.cell);
  const std::optional<TruePoses> truth = true_poses_if_any(arguments, session);
  Json json{{"definitions", map_measure_definitions()}, {"map", to_json(own)}};
  std::optional<MapMeasures> at_truth;
  if (truth) {
    at_truth = measure(pieces_of(session, truth->trajectory).pieces, session, arguments.cell);
    json["at_true_poses"] = to_json(*at_truth);
  }
  if (!arguments.truth.empty()) {
    std::vector<Pose> guesses{Pose()};
    if (truth) guesses.push_back(truth->T_truth_world);
    json["against_true_map"] = compare(arguments, session, pieces.pieces, guesses);
  }
  if (arguments.json) {
    std::printf("%s\n", json.dump(2).c_str());
    return;
  }
  print_measures("map", own);
  if (at_truth) print_measures("the same scans at true poses", *at_truth);
  if (json.contains("against_true_map")) {
    std::printf("against the true map\n");
    for (const auto& [name, value] : json["against_true_map"].items())
      std::printf("  %-28s %s\n", name.c_str(), value.dump().c_str());
  }
  if (!context.quiet) std::printf("%s\n", map_measure_definitions());
}

}  // namespace

void add_evaluate_map_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "map", "how sharp a session's map is: thickness of planes, entropy, distance to a true map");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SESSION", arguments->session, "folder that `run` or `merge` left")
      ->required();
  command->add_option("--truth", arguments->truth, "true map to compare with (.pcd or .ply)");
  command->add_option("--ground-truth", arguments->ground_truth,
                      "trajectory of the same scans at true poses: TUM or KITTI");
  command->add_option("--truth-frame", arguments->truth_frame,
                      "what the poses of the ground truth are of: sensor, camera or a file");
  command->add_option("--cell", arguments->cell, "edge of the cells that are judged, metres")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command
      ->add_option("--limit", arguments->limit,
                   "distance up to which points of map and true map match, metres")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command
      ->add_option("--voxel", arguments->voxel,
                   "edge of the voxels whose spread is compared with the true map's, metres")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace groundloop::apps
