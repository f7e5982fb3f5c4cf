#include "apps/report/trajectory_evaluation_json.hpp"

#include <cstdio>

#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

std::string row(const char* name, const Statistics& s) {
  char line[160];
  std::snprintf(line, sizeof line, "  %-22s %10.4f %10.4f %10.4f %10.4f %10.4f %10.4f\n", name,
                s.rmse, s.mean, s.median, s.std, s.min, s.max);
  return line;
}

nlohmann::ordered_json to_json(const VisitDistance& distance) {
  nlohmann::ordered_json json{{"pairs", distance.pairs}, {"median_m", nullptr}, {"p95_m", nullptr}};
  if (distance.pairs == 0) return json;
  json["median_m"] = distance.median_m;
  json["p95_m"] = distance.most_m;
  return json;
}

std::string visit_row(const std::string& apart, const VisitDistance& distance) {
  char line[160];
  if (distance.pairs == 0) {
    std::snprintf(line, sizeof line, "  %s: no pair\n", apart.c_str());
  } else {
    std::snprintf(line, sizeof line, "  %s: %.4f m median, %.4f m for 95 %% of %zu pairs\n",
                  apart.c_str(), distance.median_m, distance.most_m, distance.pairs);
  }
  return line;
}

}  // namespace

nlohmann::ordered_json to_json(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
          {"std", s.std},   {"min", s.min},   {"max", s.max}};
}

nlohmann::ordered_json to_json(const PoseErrorStatistics& s) {
  return {{"translation_m", to_json(s.translation_m)}, {"rotation_deg", to_json(s.rotation_deg)}};
}

nlohmann::ordered_json to_json(const TrajectoryEvaluation& evaluation,
                               const TrajectoryEvaluationOptions& options) {
  nlohmann::ordered_json json;
  json["pairs"] = evaluation.pairs.size();
  json["alignment"] = options.alignment;
  json["association"] = options.by_row
                            ? std::string("row")
                            : "nearest stamp within " + to_text(options.tolerance) + " s";
  json["scale"] = evaluation.alignment.scale;
  json["path_length_m"] = evaluation.path_length_m;
  json["ape"] = to_json(evaluation.ape);
  json["ape"]["x_m"] = to_json(evaluation.ape_x_m);
  json["ape"]["y_m"] = to_json(evaluation.ape_y_m);
  json["ape"]["z_m"] = to_json(evaluation.ape_z_m);
  json["rpe"] = to_json(evaluation.rpe_frame);
  json["rpe"]["delta"] = "1 pair";
  json["rpe"]["pairs"] = evaluation.rpe_frame.count;
  auto& by_distance = json["rpe"]["by_distance"];
  by_distance = to_json(evaluation.rpe_distance);
  by_distance["delta_m"] = evaluation.rpe_distance_m;
  by_distance["pairs"] = evaluation.rpe_distance.count;
  auto& kitti = json["kitti"];
  kitti["segments"] = evaluation.kitti_segments;
  // A way too short for a single segment has no such error: null, not 0.
  kitti["translation_percent"] = nullptr;
  kitti["rotation_deg_per_m"] = nullptr;
  if (evaluation.kitti_segments > 0) {
    kitti["translation_percent"] = evaluation.kitti_translation_percent;
    kitti["rotation_deg_per_m"] = evaluation.kitti_rotation_deg_per_m;
  }
  return json;
}

nlohmann::ordered_json to_json(const TruthFrame& frame) {
  const Pose& X = frame.T_truth_sensor;
  nlohmann::ordered_json json{
      {"frame", frame.name},
      {"rotation_deg", rotation_angle(X.rotation) * 180.0 / M_PI},
      {"lever_m", {X.translation.x(), X.translation.y(), X.translation.z()}},
      {"found_from_motion", frame.found}};
  if (frame.found) {
    json["rotation_deviation_deg"] = frame.rotation_deviation_deg;
    json["lever_deviation_m"] = frame.lever_deviation_m;
  }
  if (frame.told) {
    json["fits"] = frame.fits;
    json["disagreement_percent"] = frame.disagreement_percent;
    json["disagreement_deg"] = frame.disagreement_deg;
  }
  return json;
}

nlohmann::ordered_json to_json(const VisitDistances& visits) {
  return {{"definition",
           "norm of the translation of T_estimate^-1 T_truth, T the pose of one scan in another "
           "within 5 m; by_way: more than 100 m of way apart; by_time: more than 30 s and 20 m of "
           "way; scans at every metre of the way"},
          {"by_way", to_json(visits.by_way)},
          {"by_time", to_json(visits.by_time)}};
}

std::string to_table(const VisitDistances& visits) {
  return "two visits of a place (scans within 5 m of each other, relative pose against the "
         "truth)\n" +
         visit_row("more than 100 m of way apart", visits.by_way) +
         visit_row("more than 30 s and 20 m apart", visits.by_time);
}

std::string to_table(const TrajectoryEvaluation& evaluation,
                     const TrajectoryEvaluationOptions& options) {
  char line[200];
  std::snprintf(line, sizeof line,
                "%zu pairs over %.1f m, alignment %s (scale %.6f), paired by %s\n",
                evaluation.pairs.size(), evaluation.path_length_m, options.alignment.c_str(),
                evaluation.alignment.scale, options.by_row ? "row" : "nearest stamp");
  std::string text = line;
  std::snprintf(line, sizeof line, "  %-22s %10s %10s %10s %10s %10s %10s\n", "", "rmse", "mean",
                "median", "std", "min", "max");
  text += line;
  text += row("APE translation [m]", evaluation.ape.translation_m);
  text += row("  along x [m]", evaluation.ape_x_m);
  text += row("  along y [m]", evaluation.ape_y_m);
  text += row("  along z [m]", evaluation.ape_z_m);
  text += row("APE rotation [deg]", evaluation.ape.rotation_deg);
  text += row("RPE 1 pair [m]", evaluation.rpe_frame.translation_m);
  text += row("RPE 1 pair [deg]", evaluation.rpe_frame.rotation_deg);
  if (evaluation.rpe_distance.count > 0) {
    const std::string way = "RPE " + to_text(evaluation.rpe_distance_m) + " m ";
    text += row((way + "[m]").c_str(), evaluation.rpe_distance.translation_m);
    text += row((way + "[deg]").c_str(), evaluation.rpe_distance.rotation_deg);
  }
  if (evaluation.kitti_segments > 0) {
    std::snprintf(line, sizeof line, "KITTI, %zu segments of 100 to 800 m: %.4f %%, %.6f deg/m\n",
                  evaluation.kitti_segments, evaluation.kitti_translation_percent,
                  evaluation.kitti_rotation_deg_per_m);
  } else {
    std::snprintf(line, sizeof line, "KITTI: no segment, the way is shorter than 100 m\n");
  }
  return text + line;
}

}  // namespace groundloop::apps
