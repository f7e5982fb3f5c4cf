#include "apps/report/session_documents.hpp"

#include <algorithm>
#include <cmath>

#include <sys/resource.h>

#include "apps/report/trajectory_evaluation_json.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

Json summary_document(const OptimizationSummary& s) {
  return {{"cost_before", s.cost_before}, {"cost_after", s.cost_after},
          {"iterations", s.iterations},   {"initialisation", s.initialisation},
          {"termination", s.termination}, {"rejected_edges", s.rejected_edges.size()}};
}

Json quality_document(const MapQuality& quality) {
  if (quality.pairs == 0) return {{"pairs", 0}};
  const auto figures = [](const RevisitQuality& q) -> Json {
    return {{"plane_thickness_m", q.plane_thickness}, {"entropy", q.entropy}, {"cells", q.cells}};
  };
  return {{"pairs", quality.pairs},
          {"before", figures(quality.before)},
          {"after", figures(quality.after)},
          {"worse", quality.worse},
          {"given_up", quality.given_up}};
}

Json trust_document(const OdometryTrust& trust) {
  Json scans = Json::object();
  for (const OdometryState state :
       {OdometryState::good, OdometryState::weak, OdometryState::lost, OdometryState::predicted})
    scans[to_string(state)] = trust.count(state);
  Json lost = Json::array();
  for (const LostStretch& stretch : trust.lost) {
    lost.push_back({{"first_scan", stretch.first_scan},
                    {"last_scan", stretch.last_scan},
                    {"from_s", stretch.from_s},
                    {"to_s", stretch.to_s},
                    {"reason", to_string(stretch.reason)}});
  }
  return {{"state", to_string(trust.state)}, {"scans", scans}, {"lost", lost}};
}

Json ape_document(const TrajectoryEvaluation& e) {
  return to_json(e, TrajectoryEvaluationOptions{}).at("ape");
}

Json rpe_document(const TrajectoryEvaluation& e) {
  return to_json(e, TrajectoryEvaluationOptions{}).at("rpe");
}

Json kitti_document(const TrajectoryEvaluation& e) {
  return to_json(e, TrajectoryEvaluationOptions{}).at("kitti");
}

Json visits_document(const Trajectory& estimate, const RunEvaluation& evaluation,
                     const TrajectoryEvaluation& of_estimate) {
  return to_json(visit_distances(estimate, evaluation.ground_truth, of_estimate.pairs));
}

}  // namespace

Json recording_document(const RecordingInfo& info, std::size_t scans) {
  return {{"path", info.path},
          {"format", info.format},
          {"sensor", info.sensor},
          {"scans", scans},
          {"point_times", info.point_times},
          {"stamp_source", info.stamp_source},
          {"fields", info.fields},
          {"notes", info.notes},
          {"warnings", info.warnings},
          {"out_of_order", info.out_of_order},
          {"duplicates", info.duplicates},
          {"gaps", info.gaps},
          {"dropped_scans", info.dropped_scans}};
}

Json metrics_document(const SlamResult& result, const std::optional<RunEvaluation>& evaluation,
                      const std::optional<ReportCost>& report) {
  const auto count = [&](auto predicate) {
    return std::count_if(result.closures.begin(), result.closures.end(), predicate);
  };
  Json closures;
  closures["candidates"] =
      count([](const ClosureRecord& c) { return c.source == ClosureSource::detector; });
  closures["accepted"] =
      count([](const ClosureRecord& c) { return c.status == ClosureStatus::accepted; });
  closures["accepted_by_source"] = {
      {"detector", count([](const ClosureRecord& c) {
         return c.status == ClosureStatus::accepted && c.source == ClosureSource::detector;
       })},
      {"overlap", count([](const ClosureRecord& c) {
         return c.status == ClosureStatus::accepted && c.source == ClosureSource::overlap;
       })}};
  Json by_status = Json::object();
  for (const ClosureStatus status :
       {ClosureStatus::accepted, ClosureStatus::few_inliers, ClosureStatus::icp_diverged,
        ClosureStatus::low_overlap, ClosureStatus::inconsistent, ClosureStatus::outlier}) {
    by_status[to_string(status)] =
        count([&](const ClosureRecord& c) { return c.status == status; });
  }
  closures["by_status"] = by_status;
  closures["overlap_pairs_tried"] = result.solution.revisits_tried;

  const StageTimes& t = result.times;
  // Standard deviation over the local maps.
  const auto deviation = [&](double sum, double squares) {
    const auto n = static_cast<double>(std::max<std::size_t>(1, result.maps.size()));
    return std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)));
  };
  Json document{
      {"scans", result.odometry.size()},
      {"predicted_scans", result.predicted_scans},
      {"odometry", trust_document(result.trust)},
      {"unusable_scans", result.unusable_scans},
      {"local_maps", result.maps.size()},
      {"path_length_m", path_length(result.solution.trajectory)},
      {"closures", closures},
      {"timing_s",
       {{"read", t.read},
        {"odometry", t.odometry},
        {"local_maps", t.local_maps},
        {"keeping", t.keeping},
        {"ground_alignment", t.ground_alignment},
        {"density_image", t.density_image},
        {"features", t.features},
        {"matching", t.matching},
        {"consensus", t.consensus},
        {"verification", t.verification},
        {"levelling", t.levelling},
        {"optimisation", t.optimisation},
        {"map_quality", t.map_quality},
        {"map", t.map},
        {"total", t.total}}},
      {"timing_deviation_s",
       {{"ground_alignment", deviation(t.ground_alignment, t.squares.ground_alignment)},
        {"detection", deviation(t.density_image + t.features + t.matching, t.squares.detection)},
        {"consensus", deviation(t.consensus, t.squares.consensus)}}},
      {"scans_per_second",
       t.total > 0.0 ? static_cast<double>(result.odometry.size()) / t.total : 0.0},
      {"peak_memory_mb", peak_memory_mb()},
      {"pose_graph",
       {{"odometry_scale", result.solution.odometry_scale},
        {"key_poses", summary_document(result.solution.key_summary)},
        {"all_scans", summary_document(result.solution.summary)}}}};
  const Levelling& levelling = result.solution.levelling;
  document["levelling"] = {
      {"applied", levelling.applied},       {"maps", levelling.maps},
      {"bend_rad_per_m", levelling.bend},   {"bend_deviation_rad_per_m", levelling.bend_deviation},
      {"walk_scale", levelling.walk_scale}, {"scatter_rad", levelling.scatter}};
  document["map_quality"] = quality_document(result.solution.map_quality);
  if (evaluation) {
    document["ape"] = {{"alignment", "se3"},
                       {"pairs", evaluation->optimised.pairs.size()},
                       {"odometry", ape_document(evaluation->odometry)},
                       {"optimised", ape_document(evaluation->optimised)}};
    document["rpe"] = {{"odometry", rpe_document(evaluation->odometry)},
                       {"optimised", rpe_document(evaluation->optimised)}};
    document["visits"] = {
        {"odometry", visits_document(result.odometry, *evaluation, evaluation->odometry)},
        {"optimised",
         visits_document(result.solution.trajectory, *evaluation, evaluation->optimised)}};
    document["ground_truth"] = to_json(evaluation->frame);
    document["ground_truth"]["instant_s"] = evaluation->instant_s;
    document["kitti"] = {{"odometry", kitti_document(evaluation->odometry)},
                         {"optimised", kitti_document(evaluation->optimised)}};
  }
  add_report_cost(document, report);
  return document;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace groundloop::apps
