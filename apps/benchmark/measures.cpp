#include "apps/benchmark/measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frontend/core/spelling.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;
using Extract = std::function<std::optional<double>(const ResultDocuments&)>;
using Over = Measure::Over;

std::optional<double> number_at(const Json& document, const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (!document.is_object() || !document.contains(at)) return std::nullopt;
  const Json& value = document.at(at);
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  if (!value.is_number()) return std::nullopt;
  return value.get<double>();
}

Extract metric(std::string pointer, double factor = 1.0) {
  return [pointer = std::move(pointer), factor](const ResultDocuments& d) {
    const std::optional<double> value = number_at(d.metrics, pointer);
    return value ? std::optional<double>(factor * *value) : std::nullopt;
  };
}

Extract closure(std::string pointer) {
  return [pointer = std::move(pointer)](const ResultDocuments& d) {
    return number_at(d.closures, pointer);
  };
}

Extract step(std::string pointer) {
  return [pointer = std::move(pointer)](const ResultDocuments& d) {
    return number_at(d.step, pointer);
  };
}

// A over B, both of metrics.json.
Extract ratio(std::string a, std::string b, double factor) {
  return [a = std::move(a), b = std::move(b), factor](const ResultDocuments& d) {
    const std::optional<double> value = number_at(d.metrics, a), by = number_at(d.metrics, b);
    if (!value || !by || *by == 0.0) return std::optional<double>();
    return std::optional<double>(factor * *value / *by);
  };
}

std::optional<double> detection(const ResultDocuments& d) {
  double seconds = 0.0;
  for (const char* stage : {"density_image", "features", "matching"}) {
    const auto value = number_at(d.metrics, std::string("/timing_s/") + stage);
    if (!value) return std::nullopt;
    seconds += *value;
  }
  const auto maps = number_at(d.metrics, "/local_maps");
  return maps && *maps > 0 ? std::optional<double>(1000 * seconds / *maps) : std::nullopt;
}

// The root mean square along x and y together.
Extract horizontal(const std::string& stage) {
  return [stage](const ResultDocuments& d) {
    const std::optional<double> x = number_at(d.metrics, "/ape/" + stage + "/x_m/rmse");
    const std::optional<double> y = number_at(d.metrics, "/ape/" + stage + "/y_m/rmse");
    return x && y ? std::optional<double>(std::hypot(*x, *y)) : std::nullopt;
  };
}

// The one pair of sessions of a merge.
std::optional<double> joined(const ResultDocuments& d) {
  return number_at(d.metrics, "/pairs/0/one_frame");
}

// How far the second recording lies off by the alignment of the first.
std::optional<double> of_second(const ResultDocuments& d, const std::string& pointer) {
  if (!d.metrics.is_object() || !d.metrics.contains("sessions")) return std::nullopt;
  for (const auto& session : d.metrics.at("sessions")) {
    const Json& by_reference = session.at("ape").at("by_reference");
    if (const auto value = number_at(by_reference, pointer)) return value;
  }
  return std::nullopt;
}

std::optional<double> f1_at_threshold(const ResultDocuments& d) {
  const auto precision = number_at(d.closures, "/detector/at_threshold/precision");
  const auto recall = number_at(d.closures, "/detector/at_threshold/recall");
  if (!precision || !recall) return std::nullopt;
  return *precision + *recall > 0 ? 2 * *precision * *recall / (*precision + *recall) : 0.0;
}

constexpr double kRightlyJoined = 3.0;  // m, as merge_documents has it of closures

std::optional<double> rightly_joined(const ResultDocuments& d) {
  const std::optional<double> one_frame = joined(d);
  if (!one_frame) return std::nullopt;
  if (!d.expected_to_join) return 1.0 - *one_frame;
  const std::optional<double> error = of_second(d, "/translation_m/rmse");
  return *one_frame > 0 && error && *error <= kRightlyJoined ? 1.0 : 0.0;
}

enum class Figure { average_precision, full_precision_recall, max_f1 };

Measure of_curve(std::string name, std::string heading, Figure figure, Counting counting,
                 std::string definition) {
  Measure m{std::move(name), std::move(heading), 3, 1, std::move(definition), {}, Over::pooled, {}};
  m.pool = [figure, counting](const std::vector<const Detections*>& detections) {
    const bool poses = std::any_of(detections.begin(), detections.end(),
                                   [](const Detections* d) { return d->poses; });
    if (counting == Counting::with_right_pose && !poses) return std::optional<double>();
    const PrecisionRecall curve = pooled_curve(detections, counting);
    if (curve.references == 0) return std::optional<double>();
    switch (figure) {
      case Figure::average_precision:
        return curve.average_precision;
      case Figure::full_precision_recall:
        return curve.recall_at_full_precision;
      case Figure::max_f1:
        break;
    }
    return curve.max_f1;
  };
  return m;
}

Measure chance() {
  Measure m{"chance",
            "chance",
            3,
            0,
            "average precision that guessing has: reference closures over eligible pairs",
            {},
            Over::pooled,
            {}};
  m.pool = [](const std::vector<const Detections*>& detections) {
    std::size_t references = 0, eligible = 0;
    for (const Detections* d : detections) references += d->references, eligible += d->eligible;
    if (eligible == 0) return std::optional<double>();
    return std::optional<double>(static_cast<double>(references) / static_cast<double>(eligible));
  };
  return m;
}

std::vector<Measure> trajectory_measures() {
  return {
      {"scans", "scans", 0, 0, "scans of the recording", metric("/scans"), Over::sum, {}},
      {"maps", "maps", 0, 0, "local maps", metric("/local_maps"), Over::sum, {}},
      {"path",
       "way km",
       2,
       0,
       "length of the optimised trajectory",
       metric("/path_length_m", 1e-3),
       Over::sum,
       {}},
      {"drift",
       "drift %",
       2,
       -1,
       "KITTI's metric of the odometry: position error at the end of segments of 100 to 800 m, in "
       "per cent of their length, the mean over all segments",
       metric("/kitti/odometry/translation_percent"),
       Over::mean,
       {}},
      {"drift_turn",
       "drift deg/100 m",
       3,
       -1,
       "the same of the rotation",
       metric("/kitti/odometry/rotation_deg_per_m", 100.0),
       Over::mean,
       {}},
      {"rpe",
       "RPE m",
       3,
       -1,
       "relative position error of the odometry from scan to scan, rmse",
       metric("/rpe/odometry/translation_m/rmse"),
       Over::mean,
       {}},
      {"rpe_turn",
       "RPE deg",
       3,
       -1,
       "the same of the rotation",
       metric("/rpe/odometry/rotation_deg/rmse"),
       Over::mean,
       {}},
      {"ape_odometry",
       "APE odometry m",
       3,
       -1,
       "absolute position error of the odometry, rmse after SE(3) alignment",
       metric("/ape/odometry/translation_m/rmse"),
       Over::mean,
       {}},
      {"ape_odometry_horizontal",
       "horizontal m",
       3,
       -1,
       "along x and y of the ground truth's frame, of the odometry",
       horizontal("odometry"),
       Over::mean,
       {}},
      {"ape_odometry_vertical",
       "vertical m",
       3,
       -1,
       "along z of the ground truth's frame, of the odometry",
       metric("/ape/odometry/z_m/rmse"),
       Over::mean,
       {}},
      {"ape",
       "APE optimised m",
       3,
       -1,
       "absolute position error of the optimised trajectory, rmse after SE(3) alignment",
       metric("/ape/optimised/translation_m/rmse"),
       Over::mean,
       {}},
      {"ape_horizontal",
       "horizontal m",
       3,
       -1,
       "along x and y, of the optimised trajectory",
       horizontal("optimised"),
       Over::mean,
       {}},
      {"ape_vertical",
       "vertical m",
       3,
       -1,
       "along z, of the optimised trajectory",
       metric("/ape/optimised/z_m/rmse"),
       Over::mean,
       {}},
      {"ape_turn",
       "APE deg",
       3,
       -1,
       "absolute rotation error of the optimised trajectory, rmse",
       metric("/ape/optimised/rotation_deg/rmse"),
       Over::mean,
       {}},
  };
}

std::vector<Measure> closure_measures() {
  std::vector<Measure> list{
      {"references",
       "references",
       0,
       0,
       "reference closures: pairs of local maps, rebuilt from the scans at true poses, that share "
       "more of the smaller one's 0.5 m voxels than the threshold",
       closure("/references/count"),
       Over::sum,
       {}},
      {"uncertain",
       "uncertain",
       0,
       0,
       "of the reference closures, those whose overlap is within a fifth of the threshold",
       closure("/references/uncertain"),
       Over::sum,
       {}},
      {"eligible",
       "eligible",
       0,
       0,
       "pairs that a detector could report; those of the maps just before the query are none",
       closure("/references/eligible"),
       Over::sum,
       {}},
      {"true",
       "true",
       0,
       0,
       "reported closures that pass the detector's threshold, true",
       closure("/detector/at_threshold/true_positives"),
       Over::sum,
       {}},
      {"false",
       "false",
       0,
       0,
       "the same, false",
       closure("/detector/at_threshold/false_positives"),
       Over::sum,
       {}},
      {"detection_precision",
       "precision",
       3,
       1,
       "of the reported closures that pass the detector's threshold",
       closure("/detector/at_threshold/precision"),
       Over::mean,
       {}},
      {"detection_recall",
       "recall",
       3,
       1,
       "of them, over the reference closures",
       closure("/detector/at_threshold/recall"),
       Over::mean,
       {}},
      {"detection_f1", "F1", 3, 1, "of these two", f1_at_threshold, Over::mean, {}},
      {"graph_true",
       "graph true",
       0,
       0,
       "closures in the final graph, true",
       closure("/final_graph/true_positives"),
       Over::sum,
       {}},
      {"graph_false",
       "graph false",
       0,
       0,
       "closures in the final graph whose pair is no reference closure",
       closure("/final_graph/false_positives"),
       Over::sum,
       {}},
      {"graph_wrong",
       "graph wrong",
       0,
       -1,
       "closures in the final graph whose pose is wrong where the maps meet, whatever their "
       "overlap",
       closure("/final_graph/wrong_pose"),
       Over::sum,
       {}},
      {"graph_recall",
       "graph recall",
       3,
       1,
       "share of the reference closures that are in the final graph",
       closure("/final_graph/recall"),
       Over::mean,
       {}},
  };
  list.push_back(chance());
  list.push_back(of_curve("ap", "AP", Figure::average_precision, Counting::all,
                          "average precision over the scores of all reported closures, ties "
                          "together; recordings of a row are pooled"));
  list.push_back(of_curve("r1", "R@1", Figure::full_precision_recall, Counting::all,
                          "greatest recall at full precision; - where no threshold reaches it"));
  list.push_back(of_curve("f1", "F1", Figure::max_f1, Counting::all, "greatest F1 score"));
  list.push_back(of_curve("ap_certain", "AP certain", Figure::average_precision, Counting::certain,
                          "average precision without pairs whose overlap is within a fifth of "
                          "the threshold"));
  list.push_back(of_curve("r1_certain", "R@1 certain", Figure::full_precision_recall,
                          Counting::certain, "greatest recall at full precision without them"));
  list.push_back(of_curve("ap_pose", "AP pose", Figure::average_precision,
                          Counting::with_right_pose,
                          "average precision where a closure is true only if its pose is within "
                          "3 m and 5 degrees of the truth where the maps meet"));
  list.push_back(of_curve("r1_pose", "R@1 pose", Figure::full_precision_recall,
                          Counting::with_right_pose, "greatest recall at full precision likewise"));
  return list;
}

std::vector<Measure> pose_measures() {
  std::vector<Measure> list;
  const auto add = [&](const std::string& prefix, const std::string& which,
                       const std::string& place, const std::string& pointer) {
    const std::string what = which + " pose error of true closures, " + place;
    list.push_back({prefix + "_closures",
                    "closures",
                    0,
                    0,
                    "closures counted: " + what,
                    closure(pointer + "/closures"),
                    Over::sum,
                    {}});
    list.push_back({prefix + "_m",
                    "median m",
                    3,
                    -1,
                    "median " + what,
                    closure(pointer + "/translation_m/median"),
                    Over::mean,
                    {}});
    list.push_back({prefix + "_rms_m",
                    "rms m",
                    3,
                    -1,
                    "root mean square " + what,
                    closure(pointer + "/translation_m/rmse"),
                    Over::mean,
                    {}});
    list.push_back({prefix + "_deg",
                    "median deg",
                    3,
                    -1,
                    "median " + what,
                    closure(pointer + "/rotation_deg/median"),
                    Over::mean,
                    {}});
    list.push_back({prefix + "_rms_deg",
                    "rms deg",
                    3,
                    -1,
                    "root mean square " + what,
                    closure(pointer + "/rotation_deg/rmse"),
                    Over::mean,
                    {}});
  };
  add("initial_meeting", "initial", "where the maps meet", "/alignment/initial_meeting");
  add("refined_meeting", "refined", "where the maps meet", "/alignment/refined_meeting");
  add("initial_origin", "initial", "at the maps' origins", "/alignment/initial_absolute");
  add("refined_origin", "refined", "at the maps' origins", "/alignment/refined_absolute");
  add("initial_proxy", "initial", "against point-to-point ICP from the true pose",
      "/alignment/initial_to_proxy");
  add("refined_proxy", "refined", "against point-to-point ICP from the true pose",
      "/alignment/refined_to_proxy");
  list.push_back({"overlap_error",
                  "overlap error",
                  3,
                  -1,
                  "root mean square of the overlap at the initial pose less that of the reference "
                  "maps, over true closures with at least five inliers",
                  closure("/overlap_error/rmse"),
                  Over::mean,
                  {}});
  return list;
}

std::vector<Measure> merging_measures() {
  return {
      {"joined",
       "joined",
       2,
       0,
       "share of the pairs that came into one frame",
       joined,
       Over::mean,
       {}},
      {"right",
       "right",
       2,
       1,
       "share of the pairs that were joined with the second session within 3 m (rmse, by the "
       "first one's alignment), or, where they share no place, were not joined",
       rightly_joined,
       Over::mean,
       {}},
      {"relative",
       "relative m",
       3,
       -1,
       "position error of the second session by the alignment of the first, rmse",
       [](const ResultDocuments& d) { return of_second(d, "/translation_m/rmse"); },
       Over::mean,
       {}},
      {"relative_turn",
       "relative deg",
       3,
       -1,
       "the same of the rotation",
       [](const ResultDocuments& d) { return of_second(d, "/rotation_deg/rmse"); },
       Over::mean,
       {}},
      {"joint_ape",
       "joint APE m",
       3,
       -1,
       "absolute position error of both sessions with one alignment, rmse",
       metric("/ape/optimised/translation_m/rmse"),
       Over::mean,
       {}},
      {"between_accepted",
       "closures",
       0,
       0,
       "closures between the sessions in the final graph",
       metric("/closures/between_sessions/accepted"),
       Over::sum,
       {}},
      {"between_precision",
       "precision",
       3,
       1,
       "share of them within 3 m of the ground truth at the maps' origins",
       metric("/closures_against_ground_truth/precision"),
       Over::mean,
       {}},
      {"merge_seconds",
       "s",
       1,
       -1,
       "clock of the merge",
       metric("/timing_s/total"),
       Over::mean,
       {}},
  };
}

std::vector<Measure> quality_measures() {
  return {
      {"revisits",
       "revisits",
       0,
       0,
       "pairs of maps measured where a place was seen twice",
       metric("/map_quality/pairs"),
       Over::sum,
       {}},
      {"thickness_before",
       "before m",
       3,
       -1,
       "mean distance of surfaces seen twice, at the odometry's poses",
       metric("/map_quality/before/plane_thickness_m"),
       Over::mean,
       {}},
      {"thickness",
       "after m",
       3,
       -1,
       "the same at the optimised poses",
       metric("/map_quality/after/plane_thickness_m"),
       Over::mean,
       {}},
      {"entropy_before",
       "entropy before",
       3,
       -1,
       "mean map entropy (Droeschel et al. 2014) of 1 m cells seen twice, at the odometry's poses",
       metric("/map_quality/before/entropy"),
       Over::mean,
       {}},
      {"entropy",
       "entropy after",
       3,
       -1,
       "the same at the optimised poses",
       metric("/map_quality/after/entropy"),
       Over::mean,
       {}},
      {"given_up",
       "given up",
       2,
       -1,
       "share of the runs whose closures were given up, since the map got worse by them",
       metric("/map_quality/given_up"),
       Over::mean,
       {}},
      {"odometry_scale",
       "odometry scale",
       2,
       0,
       "factor on the odometry's stated standard deviations that its closures ask for",
       metric("/pose_graph/odometry_scale"),
       Over::mean,
       {}},
  };
}

std::vector<Measure> time_measures() {
  std::vector<Measure> list{
      {"scans_per_second",
       "scans/s",
       1,
       1,
       "scans over the clock of the whole run",
       metric("/scans_per_second"),
       Over::mean,
       {}},
      {"scans_per_map",
       "scans a map",
       0,
       0,
       "scans in a local map",
       ratio("/scans", "/local_maps", 1.0),
       Over::mean,
       {}},
      {"memory",
       "memory MB",
       0,
       -1,
       "peak of resident memory",
       metric("/peak_memory_mb"),
       Over::mean,
       {}},
      {"processor",
       "processor s",
       1,
       -1,
       "processor seconds of the run, all threads",
       step("/processor_seconds"),
       Over::mean,
       {}},
  };
  const auto add = [&](const std::string& stage, const std::string& heading, const std::string& by,
                       const std::string& what) {
    list.push_back({"t_" + stage,
                    heading,
                    2,
                    -1,
                    "busy milliseconds of " + what,
                    ratio("/timing_s/" + stage, by, 1000.0),
                    Over::mean,
                    {}});
  };
  add("read", "reading ms", "/scans", "reading, a scan");
  add("odometry", "odometry ms", "/scans", "odometry, a scan");
  add("ground_alignment", "ground ms", "/local_maps", "ground alignment, a map");
  add("density_image", "image ms", "/local_maps", "the density image, a map");
  add("features", "features ms", "/local_maps", "features and pruning, a map");
  add("matching", "matching ms", "/local_maps", "matching, a map");
  add("consensus", "consensus ms", "/local_maps", "consensus, a map");
  add("verification", "verification ms", "/local_maps", "verification by registration, a map");
  add("optimisation", "optimisation ms", "/scans", "optimisation, a scan");
  list.push_back({"t_detection",
                  "detection ms",
                  2,
                  -1,
                  "busy milliseconds of density image, features and matching, a map",
                  detection,
                  Over::mean,
                  {}});
  const auto deviation = [&](const std::string& stage, const std::string& what) {
    list.push_back({"s_" + stage,
                    "deviation ms",
                    2,
                    0,
                    "standard deviation of the same over the maps, " + what,
                    metric("/timing_deviation_s/" + stage, 1000.0),
                    Over::mean,
                    {}});
  };
  deviation("ground_alignment", "ground alignment");
  deviation("detection", "density image, features and matching");
  deviation("consensus", "consensus");
  list.push_back(
      {"speed",
       "scans/s",
       1,
       1,
       "scans of the recording over the processor seconds of the step that this row is: a "
       "whole run, or a detector's on a finished session",
       [](const ResultDocuments& d) {
         const auto scans = number_at(d.session, "/scans");
         const auto seconds = number_at(d.step, "/processor_seconds");
         if (!scans || !seconds || *seconds <= 0) return std::optional<double>();
         return std::optional<double>(*scans / *seconds);
       },
       Over::mean,
       {}});
  return list;
}

}  // namespace

const std::vector<Measure>& measures() {
  static const std::vector<Measure> all = [] {
    std::vector<Measure> list;
    for (std::vector<Measure> part : {trajectory_measures(), closure_measures(), pose_measures(),
                                      merging_measures(), quality_measures(), time_measures()}) {
      for (Measure& m : part) list.push_back(std::move(m));
    }
    return list;
  }();
  return all;
}

const Measure* find_measure(std::string_view name) {
  for (const Measure& m : measures()) {
    if (m.name == name) return &m;
  }
  return nullptr;
}

std::string nearest_measure(std::string_view name) {
  std::vector<std::string> names;
  for (const Measure& m : measures()) names.push_back(m.name);
  return nearest_word(name, names);
}

}  // namespace groundloop::apps
