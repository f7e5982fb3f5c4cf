#include "apps/commands/closure_evaluation_documents.hpp"

#include <cstdio>

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr TravelDirection kDirections[] = {TravelDirection::same, TravelDirection::opposite,
                                           TravelDirection::crossing, TravelDirection::apart};
constexpr double kOtherLane = 2.0;  // m

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json to_json(const ErrorStatistics& s) {
  if (s.count == 0) return nullptr;
  return {{"median", s.median}, {"mean", s.mean}, {"rmse", s.rmse}, {"max", s.max}};
}

Json to_json(const PoseErrors& e) {
  return {{"closures", e.translation_m.count},
          {"translation_m", to_json(e.translation_m)},
          {"rotation_deg", to_json(e.rotation_deg)}};
}

Json to_json(const std::optional<PoseError>& e) {
  return e ? Json{{"m", e->translation_m}, {"deg", e->rotation_deg}} : Json(nullptr);
}

Json to_json(const DetectionCounts& c) {
  return {{"true_positives", c.true_positives},
          {"false_positives", c.false_positives},
          {"true_wrong_pose", c.true_wrong_pose},
          {"false_right_pose", c.false_right_pose},
          {"wrong_pose", c.wrong_pose},
          {"precision", number(c.precision)},
          {"recall", number(c.recall)}};
}

Json to_json(const PrecisionRecall& curve) {
  return {{"average_precision", number(curve.average_precision)},
          {"recall_at_full_precision", number(curve.recall_at_full_precision)},
          {"max_f1", number(curve.max_f1)}};
}

Json curve_json(const PrecisionRecall& detector) {
  Json curve = Json::array();
  for (const auto& p : detector.curve) {
    curve.push_back({{"score", p.threshold},
                     {"true_positives", p.true_positives},
                     {"false_positives", p.false_positives},
                     {"precision", p.precision},
                     {"recall", p.recall},
                     {"f1", p.f1}});
  }
  return curve;
}

struct DirectionCounts {
  std::size_t references = 0, detected = 0, in_final_graph = 0;
  DirectionCounts& operator+=(const DirectionCounts& other) {
    references += other.references;
    detected += other.detected;
    in_final_graph += other.in_final_graph;
    return *this;
  }
};

// Of the references whose ways run this way; `lane_m`: whose ways lie farther apart than this.
DirectionCounts count(const ClosureEvaluation& e, TravelDirection direction, double lane_m) {
  DirectionCounts counts;
  for (const ReferenceClosure& r : e.references) {
    if (r.direction != direction || r.distance <= lane_m) continue;
    counts += {1, r.detected ? 1U : 0U, r.in_final_graph ? 1U : 0U};
  }
  return counts;
}

Json to_json(const DirectionCounts& c) {
  return {
      {"references", c.references}, {"detected", c.detected}, {"in_final_graph", c.in_final_graph}};
}

Json judged_json(const ClosureEvaluation& e) {
  Json list = Json::array();
  const auto key = [](const MapKey& k) { return Json{k.session, k.map}; };
  for (const JudgedClosure& j : e.judged) {
    if (!j.closure.detector) continue;
    list.push_back({{"reference", key(j.closure.reference)},
                    {"query", key(j.closure.query)},
                    {"score", j.closure.score},
                    {"overlap", j.overlap},
                    {"true", j.correct},
                    {"uncertain", j.uncertain},
                    {"right_pose", j.initial_right},
                    {"in_final_graph", j.closure.accepted},
                    {"initial_meeting", to_json(j.initial_meeting)},
                    {"initial_origin", to_json(j.initial_origin)}});
  }
  return list;
}

Json directions_json(const ClosureEvaluation& e) {
  Json directions = Json::object();
  for (const TravelDirection d : kDirections) directions[to_string(d)] = to_json(count(e, d, -1.0));
  DirectionCounts lane = count(e, TravelDirection::same, kOtherLane);
  lane += count(e, TravelDirection::opposite, kOtherLane);
  directions["other_lane"] = to_json(lane);
  return directions;
}

double chance(const ClosureEvaluation& e) {
  return e.eligible == 0
             ? 0.0
             : static_cast<double>(e.references.size()) / static_cast<double>(e.eligible);
}

Json definition_json(const ClosureEvaluationOptions& options) {
  return {{"overlap", options.references.overlap},
          {"overlap_between_sessions", options.references.overlap_between_sessions},
          {"uncertain_share", options.references.uncertain_share},
          {"skipped_maps", options.references.skipped_maps},
          {"pairs", options.references.pairs},
          {"reference_poses", options.references.align ? "icp" : "truth"},
          {"threshold", options.threshold},
          {"right_m", options.right_m},
          {"right_deg", options.right_deg},
          {"other_lane_m", kOtherLane}};
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

std::string text(const std::optional<double>& value) {
  return value ? text("%.3f", *value) : std::string("-");
}

std::string full_precision_note(const ClosureEvaluation& e) {
  if (e.references.empty() || e.detector.recall_at_full_precision) return "";
  return "; full precision is not reached at any threshold";
}

PageTable curve_table(const ClosureEvaluation& e, const ClosureEvaluationOptions& options) {
  const auto row = [](const std::string& name, const PrecisionRecall& curve) {
    return std::vector<std::string>{name, std::to_string(curve.references),
                                    text(curve.average_precision),
                                    text(curve.recall_at_full_precision), text(curve.max_f1)};
  };
  const std::size_t uncertain = e.uncertain_references();
  return {"Detector",
          std::to_string(e.references.size()) + " reference closures by " +
              (options.references.align ? "ICP from true poses" : "true poses") + " of " +
              std::to_string(e.eligible) + " eligible pairs (chance " + text("%.3f", chance(e)) +
              "), " + std::to_string(uncertain) + " of them uncertain" + full_precision_note(e),
          {"counted", "references", "AP", "R@1", "F1"},
          {row("all", e.detector), row("certain pairs", e.certain),
           row("with right pose", e.with_right_pose)}};
}

PageTable detection_table(const ClosureEvaluation& e, const ClosureEvaluationOptions& options) {
  const auto row = [](const std::string& name, const DetectionCounts& c) {
    return std::vector<std::string>{name,
                                    std::to_string(c.true_positives),
                                    std::to_string(c.true_wrong_pose),
                                    std::to_string(c.false_positives),
                                    std::to_string(c.false_right_pose),
                                    text(c.precision),
                                    text(c.recall)};
  };
  return {"Closures",
          "detector: score at least " + text("%g", options.threshold) +
              "; a pose is right within " + text("%g m", options.right_m) + " and " +
              text("%g degrees", options.right_deg) + " where the maps meet",
          {"closures", "true", "wrong pose", "false", "right pose", "precision", "recall"},
          {row("detector", e.at_threshold), row("final graph", e.final_graph)}};
}

PageTable direction_table(const ClosureEvaluation& e) {
  PageTable table{"By direction of travel",
                  "reference closures and how many of them were found",
                  {"direction", "references", "detector", "final graph"},
                  {}};
  for (const TravelDirection d : kDirections) {
    const DirectionCounts c = count(e, d, -1.0);
    if (c.references == 0) continue;
    table.rows.push_back({to_string(d), std::to_string(c.references), std::to_string(c.detected),
                          std::to_string(c.in_final_graph)});
  }
  return table;
}

PageTable alignment_table(const ClosureEvaluation& e) {
  PageTable table{
      "Alignment",
      "of true closures; at origins the drift inside the maps is included; proxy: ICP of the "
      "session's maps from ground truth; overlap error " +
          text(e.overlap_rmse) + " over " + std::to_string(e.overlap_closures),
      {"poses", "closures", "median m", "rmse m", "median deg", "rmse deg"},
      {}};
  const auto add = [&](const std::string& name, const PoseErrors& p) {
    if (p.translation_m.count == 0) return;
    table.rows.push_back({name, std::to_string(p.translation_m.count),
                          text("%.3f", p.translation_m.median), text("%.3f", p.translation_m.rmse),
                          text("%.3f", p.rotation_deg.median), text("%.3f", p.rotation_deg.rmse)});
  };
  add("initial, meeting", e.initial_meeting);
  add("initial, origins", e.initial_absolute);
  add("initial, to proxy", e.initial_to_proxy);
  add("refined, meeting", e.refined_meeting);
  add("refined, origins", e.refined_absolute);
  add("refined, to proxy", e.refined_to_proxy);
  return table;
}

}  // namespace

Json closure_evaluation_json(const ClosureEvaluation& e, const ClosureEvaluationOptions& options,
                             const std::vector<std::string>& notes) {
  Json detector = to_json(e.detector);
  detector["certain"] = to_json(e.certain);
  detector["with_right_pose"] = to_json(e.with_right_pose);
  detector["at_threshold"] = to_json(e.at_threshold);
  detector["curve"] = curve_json(e.detector);
  return {{"definition", definition_json(options)},
          {"notes", notes},
          {"references",
           {{"count", e.references.size()},
            {"uncertain", e.uncertain_references()},
            {"eligible", e.eligible},
            {"chance", chance(e)}}},
          {"dropped", e.dropped},
          {"detector", detector},
          {"final_graph", to_json(e.final_graph)},
          {"by_direction", directions_json(e)},
          {"alignment",
           {{"initial_meeting", to_json(e.initial_meeting)},
            {"refined_meeting", to_json(e.refined_meeting)},
            {"initial_absolute", to_json(e.initial_absolute)},
            {"refined_absolute", to_json(e.refined_absolute)},
            {"initial_to_proxy", to_json(e.initial_to_proxy)},
            {"refined_to_proxy", to_json(e.refined_to_proxy)}}},
          {"overlap_error", {{"closures", e.overlap_closures}, {"rmse", number(e.overlap_rmse)}}},
          {"judged", judged_json(e)}};
}

std::vector<PageTable> closure_evaluation_tables(const ClosureEvaluation& e,
                                                 const ClosureEvaluationOptions& options) {
  std::vector<PageTable> tables{curve_table(e, options), detection_table(e, options),
                                direction_table(e), alignment_table(e)};
  std::erase_if(tables, [](const PageTable& t) { return t.rows.empty(); });
  return tables;
}

}  // namespace groundloop::apps
