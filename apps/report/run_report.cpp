#include "apps/report/run_report.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "apps/report/closure_pictures.hpp"
#include "apps/report/report.hpp"
#include "backend/mapping/closure_anchor.hpp"
#include "frontend/core/pcd.hpp"

namespace groundloop::apps {
namespace {

std::string fixed(double value, int decimals) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, value);
  return buffer.data();
}

// T_world_scan of the ground truth at each scan that has a pose at its stamp.
std::vector<std::optional<Pose>> true_poses(const SlamResult& result,
                                            const std::optional<RunEvaluation>& evaluation) {
  std::vector<std::optional<Pose>> by_scan(result.odometry.size());
  if (evaluation) {
    for (const auto& [scan, truth] : evaluation->optimised.pairs)
      by_scan[scan] = evaluation->ground_truth[truth].pose;
  }
  return by_scan;
}

// Shown and judged at the scans that met.
ReportClosure report_closure(const ClosureRecord& c, const SlamResult& result,
                             const std::vector<std::optional<Pose>>& truth) {
  ReportClosure row;
  row.reference = std::to_string(c.reference_map);
  row.query = std::to_string(c.query_map);
  row.source = to_string(c.source);
  row.matches = c.matches;
  row.inliers = c.inliers;
  row.status = to_string(c.status);
  row.overlap = c.overlap;
  row.rmse_m = c.rmse;
  const ClosureAnchor anchor =
      anchor_closure(c.T_query_reference, result.maps[c.reference_map], result.odometry,
                     result.maps[c.query_map], result.odometry);
  const Trajectory& trajectory = result.solution.trajectory;
  row.reference_position = trajectory[anchor.reference_scan].pose.translation;
  row.query_position = trajectory[anchor.query_scan].pose.translation;
  if (truth[anchor.reference_scan] && truth[anchor.query_scan]) {
    const Pose expected = truth[anchor.query_scan]->inverse() * *truth[anchor.reference_scan];
    const Pose error = expected.inverse() * anchor.T_query_reference;
    row.error_m = error.translation.norm();
    row.error_deg = rotation_angle(error.rotation) * 180.0 / M_PI;
  }
  return row;
}

ReportTable pose_graph_table(const SessionSolution& solution) {
  const auto row = [](const char* name, const OptimizationSummary& s) -> std::vector<std::string> {
    return {name, fixed(s.cost_before, 3), fixed(s.cost_after, 3), std::to_string(s.iterations),
            s.termination};
  };
  return {"Pose graph",
          "cost = 1/2 sum of r' information r, r the SE(3) logarithm of the residual pose",
          {"graph", "cost before", "cost after", "iterations", "termination"},
          {row("key poses", solution.key_summary), row("all scans", solution.summary)}};
}

ReportTable map_quality_table(const MapQuality& quality) {
  const auto row = [](const char* name, const RevisitQuality& q) -> std::vector<std::string> {
    return {name, fixed(q.plane_thickness, 3), fixed(q.entropy, 3)};
  };
  std::string note = "Mean over " + std::to_string(quality.pairs) +
                     " pairs of local maps of the same places: distance of one map's points to the "
                     "other's surfaces (lower is sharper), and map entropy.";
  if (quality.worse) {
    note += quality.given_up ? " WORSE after closing loops: the closures were given up, the "
                               "trajectory is the odometry."
                             : " WORSE after closing loops, and kept, as the configuration asks.";
  }
  return {"Map at revisits",
          note,
          {"poses", "surfaces apart, m", "entropy"},
          {row("odometry", quality.before), row("optimised", quality.after)}};
}

}  // namespace

std::string make_run_report(const Recording& recording, const Config& config,
                            const SlamResult& result,
                            const std::optional<RunEvaluation>& evaluation,
                            const SessionFolder& session) {
  const RecordingInfo& info = recording.info();
  ReportInput input;
  input.title = info.path;
  input.facts = {{"groundloop", GROUNDLOOP_VERSION},
                 {"format", info.format},
                 {"sensor", info.sensor.empty() ? "not stated" : info.sensor},
                 {"scans", std::to_string(result.odometry.size())},
                 {"path", fixed(path_length(result.solution.trajectory), 0) + " m"},
                 {"local maps", std::to_string(result.maps.size())},
                 {"odometry's errors over the stated", fixed(result.solution.odometry_scale, 2)},
                 {"stamps", info.stamp_source},
                 {"per-point times", info.point_times},
                 {"scans a second",
                  fixed(static_cast<double>(result.odometry.size()) / result.times.total, 1)},
                 {"peak memory", fixed(peak_memory_mb(), 0) + " MB"}};
  if (const Levelling& levelling = result.solution.levelling; levelling.applied) {
    // The sagitta of the bend over a kilometre.
    input.facts.emplace_back(
        "odometry levelled",
        "by the walls in " + std::to_string(levelling.maps) + " local maps; bent by " +
            fixed(levelling.bend * 500 * 500 / 2, 2) + " +- " +
            fixed(levelling.bend_deviation * 500 * 500 / 2, 2) + " m at 500 m from the middle");
  }
  for (const std::string& note : info.notes) input.facts.emplace_back("note", note);
  input.odometry = result.odometry;
  input.optimised = result.solution.trajectory;
  if (evaluation) {
    input.ground_truth = evaluation->ground_truth;
    input.odometry_evaluation = evaluation->odometry;
    input.optimised_evaluation = evaluation->optimised;
  }
  const std::vector<std::optional<Pose>> truth = true_poses(result, evaluation);
  for (const ClosureRecord& closure : result.closures)
    input.closures.push_back(report_closure(closure, result, truth));
  const auto points = [&](int map) { return read_pcd(session.local_map(map)); };
  input.images = closure_pictures(result.closures, points, config.slam.loop_closure);
  input.tables.push_back(pose_graph_table(result.solution));
  if (result.solution.map_quality.pairs > 0)
    input.tables.push_back(map_quality_table(result.solution.map_quality));
  const StageTimes& t = result.times;
  input.timing_s = {{"read", t.read},
                    {"odometry", t.odometry},
                    {"local maps", t.local_maps},
                    {"ground alignment", t.ground_alignment},
                    {"density image", t.density_image},
                    {"features", t.features},
                    {"matching", t.matching},
                    {"consensus", t.consensus},
                    {"verification", t.verification},
                    {"levelling", t.levelling},
                    {"optimisation", t.optimisation},
                    {"map quality", t.map_quality},
                    {"map", t.map},
                    {"total (clock)", t.total}};
  input.configuration = to_yaml(config);
  return make_report(input);
}

}  // namespace groundloop::apps
