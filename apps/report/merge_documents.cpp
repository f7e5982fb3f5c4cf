#include "apps/report/merge_documents.hpp"

#include <algorithm>
#include <cmath>

#include <spdlog/spdlog.h>

#include "apps/report/joint_evaluation.hpp"
#include "apps/report/session_documents.hpp"
#include "apps/report/trajectory_evaluation_json.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

Json ape(const std::optional<TrajectoryEvaluation>& e) {
  return e ? to_json(*e, TrajectoryEvaluationOptions{}).at("ape") : Json();
}

// T_world_scan of the ground truth at the first scan of each map.
std::vector<std::optional<Pose>> true_poses(const MergedPart& part, const Trajectory& truth,
                                            const std::optional<TrajectoryEvaluation>& e) {
  std::vector<std::optional<Pose>> by_scan(part.trajectory.size());
  if (e) {
    for (const auto& [scan, row] : e->pairs) by_scan[scan] = truth[row].pose;
  }
  std::vector<std::optional<Pose>> poses;
  for (const LocalMapRecord& map : part.maps) poses.push_back(by_scan[map.first_scan]);
  return poses;
}

void add_closure_errors(const MergeResult& result, MergeEvaluation& evaluation) {
  const auto part_of = [&](const std::string& name) {
    std::size_t p = 0;
    while (result.parts[p].source->name != name) ++p;
    return p;
  };
  std::vector<std::vector<std::optional<Pose>>> poses;
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    poses.push_back(
        true_poses(result.parts[p], evaluation.ground_truth[p], evaluation.optimised[p]));
  }
  for (const ClosureRecord& c : result.closures) {
    if (c.status != ClosureStatus::accepted || c.reference_session == c.query_session) continue;
    const std::optional<Pose>& r = poses[part_of(c.reference_session)][c.reference_map];
    const std::optional<Pose>& q = poses[part_of(c.query_session)][c.query_map];
    if (!r || !q) continue;
    const Pose error = (q->inverse() * *r).inverse() * c.T_query_reference;
    evaluation.closure_errors.emplace_back(error.translation.norm(),
                                           rotation_angle(error.rotation) * 180.0 / M_PI);
  }
}

Json closure_counts(const MergeResult& result) {
  std::size_t candidates = 0;
  std::size_t accepted = 0;
  std::size_t between = 0;
  std::size_t between_accepted = 0;
  for (const ClosureRecord& c : result.closures) {
    const bool two = c.reference_session != c.query_session;
    candidates += c.source == ClosureSource::detector ? 1 : 0;
    between += two && c.source == ClosureSource::detector ? 1 : 0;
    if (c.status != ClosureStatus::accepted) continue;
    ++accepted;
    between_accepted += two ? 1 : 0;
  }
  return {{"candidates", candidates},
          {"accepted", accepted},
          {"between_sessions", {{"candidates", between}, {"accepted", between_accepted}}}};
}

// KITTI's segments, and where the way ends once its beginning is put on the ground truth's.
Json drift(const MergedPart& part, const MergeEvaluation& evaluation, std::size_t p) {
  const std::optional<TrajectoryEvaluation>& e = evaluation.odometry[p];
  if (!e || e->pairs.empty()) return {};
  const Trajectory& truth = evaluation.ground_truth[p];
  const auto travelled = [&](const Trajectory& trajectory, std::size_t from, std::size_t to) {
    return trajectory[from].pose.inverse() * trajectory[to].pose;
  };
  const auto [first, first_row] = e->pairs.front();
  const auto [last, last_row] = e->pairs.back();
  const Pose error =
      travelled(truth, first_row, last_row).inverse() * travelled(part.odometry, first, last);
  return {
      {"kitti_translation_percent", e->kitti_translation_percent},
      {"end_error_m", error.translation.norm()},
      {"end_error_percent", 100.0 * error.translation.norm() / std::max(1e-9, e->path_length_m)}};
}

const std::string& name_of(const MergeResult& result, int part) {
  return result.parts[part].source->name;
}

Json pair_document(const MergeResult& result, const SessionPair& pair) {
  const auto maps = static_cast<double>(result.parts[pair.query].maps.size());
  return {{"reference", name_of(result, pair.reference)},
          {"query", name_of(result, pair.query)},
          {"one_frame", result.parts[pair.reference].frame == result.parts[pair.query].frame},
          {"merged_before", pair.joined_before},
          {"matches_from_file", pair.from_file},
          {"candidates", pair.candidates},
          {"verified", pair.verified},
          {"accepted", pair.accepted},
          {"overlap", static_cast<double>(pair.shared_maps) / maps}};
}

}  // namespace

MergeEvaluation evaluate_merge(const MergeResult& result, std::vector<Trajectory> ground_truth) {
  MergeEvaluation evaluation;
  evaluation.ground_truth = std::move(ground_truth);
  const std::size_t n = result.parts.size();
  evaluation.odometry.resize(n);
  evaluation.optimised.resize(n);
  evaluation.by_reference.resize(n);
  JointPoses all;
  bool whole = true;
  for (std::size_t p = 0; p < n; ++p) {
    const MergedPart& part = result.parts[p];
    const Trajectory& truth = evaluation.ground_truth[p];
    whole = whole && (part.frame != result.parts.front().frame || !truth.empty());
    if (truth.empty()) continue;
    try {
      evaluation.odometry[p] = evaluate_trajectory(part.odometry, truth);
      evaluation.optimised[p] = evaluate_trajectory(part.trajectory, truth);
    } catch (const InputError& e) {
      spdlog::warn("'{}': no errors against ground truth: {}", part.source->name, e.what());
      evaluation.odometry[p].reset();
      whole = false;
      continue;
    }
    if (part.frame == result.parts.front().frame)
      all.add(part.trajectory, truth, evaluation.optimised[p]->pairs);
  }
  for (std::size_t p = 0; p < n; ++p) {
    const auto& reference = evaluation.optimised[result.parts[p].frame];
    if (!evaluation.optimised[p] || !reference || result.parts[p].frame == static_cast<int>(p))
      continue;
    JointPoses own;
    own.add(result.parts[p].trajectory, evaluation.ground_truth[p], evaluation.optimised[p]->pairs);
    evaluation.by_reference[p] = own.evaluate(reference->alignment);
  }
  if (whole && !all.empty()) evaluation.joint = all.evaluate();
  add_closure_errors(result, evaluation);
  return evaluation;
}

Manifest merge_manifest(const SessionFolder& folder, const MergeResult& result,
                        const std::vector<StoredSession>& sessions,
                        const std::vector<ManifestLeftOut>& left_out) {
  Manifest manifest;
  for (const MergedPart& part : result.parts) {
    ManifestPart entry;
    entry.name = part.source->name;
    entry.input = sessions[part.session].folder.path().string();
    entry.recording = part.source->recording;
    entry.sensor = part.source->sensor;
    entry.scans = part.trajectory.size();
    entry.first_scan = part.first_scan;
    entry.local_maps = part.maps.size();
    entry.first_map = static_cast<std::size_t>(part.first_map);
    entry.scan_files = part.source->scan_files;
    entry.first_scan_file = part.first_scan_file;
    entry.frame = name_of(result, part.frame);
    entry.connected =
        std::count_if(result.parts.begin(), result.parts.end(),
                      [&](const MergedPart& other) { return other.frame == part.frame; }) > 1;
    entry.fixed = part.fixed;
    manifest.scans += entry.scans;
    manifest.local_maps += entry.local_maps;
    manifest.scan_files += entry.scan_files;
    manifest.parts.push_back(std::move(entry));
  }
  manifest.left_out = left_out;
  manifest.connections = result.notes;
  manifest.checksums = checksums_of(folder, manifest.local_maps, manifest.scan_files);
  return manifest;
}

Json merge_metrics(const MergeResult& result, const MergeEvaluation& evaluation, double map_seconds,
                   double total_seconds) {
  std::size_t scans = 0;
  std::size_t maps = 0;
  double way = 0.0;
  Json parts = Json::object();
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    const MergedPart& part = result.parts[p];
    scans += part.trajectory.size();
    maps += part.maps.size();
    way += path_length(part.trajectory);
    parts[part.source->name] = {{"scans", part.trajectory.size()},
                                {"frame", name_of(result, part.frame)},
                                {"odometry_scale", part.odometry_scale},
                                {"odometry_drift", drift(part, evaluation, p)},
                                {"ape",
                                 {{"odometry", ape(evaluation.odometry[p])},
                                  {"optimised", ape(evaluation.optimised[p])},
                                  {"by_reference", ape(evaluation.by_reference[p])}}}};
  }
  Json pairs = Json::array();
  for (const SessionPair& pair : result.pairs) pairs.push_back(pair_document(result, pair));
  Json document{{"scans", scans},
                {"local_maps", maps},
                {"path_length_m", way},
                {"closures", closure_counts(result)},
                {"sessions", parts},
                {"pairs", pairs},
                {"connections", result.notes},
                {"timing_s",
                 {{"matching", result.times.matching},
                  {"verification", result.times.verification},
                  {"optimisation", result.times.optimisation},
                  {"map", map_seconds},
                  {"total", total_seconds}}},
                {"peak_memory_mb", peak_memory_mb()}};
  if (!evaluation.closure_errors.empty()) {
    constexpr double kTrueWithin = 3.0;
    std::vector<double> metres;
    std::vector<double> degrees;
    std::size_t right = 0;
    for (const auto& [m, deg] : evaluation.closure_errors) {
      metres.push_back(m);
      degrees.push_back(deg);
      right += m <= kTrueWithin ? 1 : 0;
    }
    document["closures_against_ground_truth"] = {
        {"pairs", metres.size()},
        {"true_within_m", kTrueWithin},
        {"precision", static_cast<double>(right) / static_cast<double>(metres.size())},
        {"translation_m", to_json(statistics(metres))},
        {"rotation_deg", to_json(statistics(degrees))}};
  }
  if (evaluation.joint) {
    document["ape"] = {{"alignment", "se3"},
                       {"pairs", evaluation.joint->pairs.size()},
                       {"optimised", ape(evaluation.joint)}};
  }
  return document;
}

}  // namespace groundloop::apps
