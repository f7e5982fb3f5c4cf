#include <cstdio>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "apps/commands/closure_evaluation_input.hpp"
#include "apps/commands/commands.hpp"
#include "apps/commands/progress_bar.hpp"
#include "apps/report/report.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/core/pcd.hpp"
#include "loopclosure/evaluation/evaluation.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string session;
  std::vector<std::string> recordings, ground_truths;
  std::string reference_poses = "auto";
  std::string report;
  bool json = false;
  ClosureEvaluationOptions options;
};

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

Json to_json(const DetectionCounts& c) {
  return {{"true_positives", c.true_positives}, {"false_positives", c.false_positives},
          {"misaligned", c.misaligned},         {"below_overlap", c.below_overlap},
          {"precision", number(c.precision)},   {"recall", number(c.recall)}};
}

struct DirectionCounts {
  std::size_t references = 0, detected = 0, in_final_graph = 0;
};

// Of the references whose ways run this way; `lane_m`: whose ways lie farther apart than this.
DirectionCounts count(const ClosureEvaluation& e, TravelDirection direction, double lane_m) {
  DirectionCounts counts;
  for (const ReferenceClosure& r : e.references) {
    if (r.direction != direction || r.distance <= lane_m) continue;
    ++counts.references;
    counts.detected += r.detected ? 1 : 0;
    counts.in_final_graph += r.in_final_graph ? 1 : 0;
  }
  return counts;
}

constexpr TravelDirection kDirections[] = {TravelDirection::same, TravelDirection::opposite,
                                           TravelDirection::crossing, TravelDirection::apart};
constexpr double kOtherLane = 2.0;  // m

Json to_json(const DirectionCounts& c) {
  return {
      {"references", c.references}, {"detected", c.detected}, {"in_final_graph", c.in_final_graph}};
}

Json to_json(const ClosureEvaluation& e, const ClosureEvaluationOptions& options) {
  Json curve = Json::array();
  for (const auto& p : e.detector.curve) {
    curve.push_back({{"min_inliers", p.threshold},
                     {"true_positives", p.true_positives},
                     {"false_positives", p.false_positives},
                     {"precision", p.precision},
                     {"recall", p.recall},
                     {"f1", p.f1}});
  }
  Json directions = Json::object();
  for (const TravelDirection d : kDirections) directions[to_string(d)] = to_json(count(e, d, -1.0));
  DirectionCounts lane;
  for (const TravelDirection d : {TravelDirection::same, TravelDirection::opposite}) {
    const DirectionCounts c = count(e, d, kOtherLane);
    lane.references += c.references;
    lane.detected += c.detected;
    lane.in_final_graph += c.in_final_graph;
  }
  directions["other_lane"] = to_json(lane);
  return {{"definition",
           {{"overlap", options.overlap},
            {"overlap_between_sessions", options.overlap_between_sessions},
            {"skipped_maps", options.skipped_maps},
            {"reference_poses", options.align_references ? "icp" : "ground_truth"},
            {"min_inliers", options.min_inliers},
            {"aligned_m", options.aligned_m},
            {"aligned_deg", options.aligned_deg},
            {"other_lane_m", kOtherLane}}},
          {"reference_closures", e.references.size()},
          {"detector",
           {{"average_precision", number(e.detector.average_precision)},
            {"recall_at_full_precision", number(e.detector.recall_at_full_precision)},
            {"max_f1", number(e.detector.max_f1)},
            {"at_min_inliers", to_json(e.detector_accepted)},
            {"curve", curve}}},
          {"final_graph", to_json(e.final_graph)},
          {"by_direction", directions},
          {"alignment",
           {{"initial_to_proxy", to_json(e.initial_to_proxy)},
            {"initial_absolute", to_json(e.initial_absolute)},
            {"refined_to_proxy", to_json(e.refined_to_proxy)},
            {"refined_absolute", to_json(e.refined_absolute)}}},
          {"overlap_error", {{"closures", e.overlap_closures}, {"rmse", number(e.overlap_rmse)}}}};
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

std::string text(const std::optional<double>& value) {
  return value ? text("%.3f", *value) : std::string("-");
}

ReportTable detection_table(const ClosureEvaluation& e) {
  const auto row = [](const std::string& name, const DetectionCounts& c) {
    return std::vector<std::string>{name,
                                    std::to_string(c.true_positives),
                                    std::to_string(c.misaligned),
                                    std::to_string(c.false_positives),
                                    std::to_string(c.below_overlap),
                                    text(c.precision),
                                    text(c.recall)};
  };
  return {
      "Closures",
      std::to_string(e.references.size()) + " reference closures; detector: average precision " +
          text(e.detector.average_precision) + ", recall at full precision " +
          text(e.detector.recall_at_full_precision) + ", greatest F1 " + text(e.detector.max_f1),
      {"closures", "true", "misaligned", "false", "aligned", "precision", "recall"},
      {row("detector", e.detector_accepted), row("final graph", e.final_graph)}};
}

ReportTable direction_table(const ClosureEvaluation& e) {
  ReportTable table{"By direction of travel",
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

ReportTable alignment_table(const ClosureEvaluation& e) {
  const auto row = [](const std::string& name, const PoseErrors& p) {
    return std::vector<std::string>{name,
                                    std::to_string(p.translation_m.count),
                                    text("%.3f", p.translation_m.median),
                                    text("%.3f", p.translation_m.rmse),
                                    text("%.3f", p.rotation_deg.median),
                                    text("%.3f", p.rotation_deg.rmse)};
  };
  return {
      "Alignment",
      "of true closures; proxy: ICP of the session's maps from ground truth; overlap error " +
          text(e.overlap_rmse) + " over " + std::to_string(e.overlap_closures),
      {"poses", "closures", "median m", "rmse m", "median deg", "rmse deg"},
      {row("initial, to proxy", e.initial_to_proxy), row("initial, absolute", e.initial_absolute),
       row("refined, to proxy", e.refined_to_proxy), row("refined, absolute", e.refined_absolute)}};
}

void print(const ReportTable& table) {
  std::printf("%s: %s\n", table.title.c_str(), table.note.c_str());
  const auto line = [](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::printf(i == 0 ? "  %-20s" : " %11s", cells[i].c_str());
    }
    std::printf("\n");
  };
  line(table.columns);
  for (const auto& row : table.rows) line(row);
}

void run(const Arguments& arguments, const Context& context) {
  ClosureEvaluationOptions options = arguments.options;
  validate(options, "evaluate closures");
  const SessionFolder session(arguments.session);
  const Progress progress = make_progress(context);
  const ClosureEvaluationInput input =
      read_evaluation_input(session, arguments.recordings, arguments.ground_truths, progress);
  options.align_references = arguments.reference_poses == "icp";
  if (arguments.reference_poses == "auto") {
    for (const EvaluatedPart& part : input.parts) {
      if (part.recording.rfind("sim:", 0) != 0) options.align_references = true;
    }
  }
  const auto load = [&](const MapKey& key) {
    const int first = input.parts[static_cast<std::size_t>(key.session)].first_map;
    return read_pcd(session.local_map(first + key.map));
  };
  const ClosureEvaluation evaluation =
      evaluate_closures(input.maps, input.closures, load, options, progress);
  end_progress();
  const ReportTable tables[] = {detection_table(evaluation), direction_table(evaluation),
                                alignment_table(evaluation)};
  if (!arguments.report.empty()) {
    ReportInput page;
    page.title = "Closures of " + session.name();
    page.tables.assign(std::begin(tables), std::end(tables));
    for (const auto& p : evaluation.detector.curve) {
      page.precision_recall.push_back({static_cast<int>(p.threshold), p.precision, p.recall});
    }
    write_text_atomically(arguments.report, make_report(page));
  }
  if (arguments.json) {
    std::printf("%s\n", to_json(evaluation, options).dump(2).c_str());
  } else {
    for (const ReportTable& table : tables) print(table);
  }
}

}  // namespace

void add_evaluate_closures_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "closures", "precision, recall and alignment of a session's closures against ground truth");
  auto arguments = std::make_shared<Arguments>();
  ClosureEvaluationOptions& options = arguments->options;
  command->add_option("session", arguments->session, "session folder, of one recording or merged")
      ->required();
  command->add_option("--recording", arguments->recordings,
                      "recording to rebuild reference maps from, one a session (default: the "
                      "manifest's)");
  command->add_option("--ground-truth", arguments->ground_truths,
                      "trajectory taken as true, one a session (default: the recording's)");
  command
      ->add_option(
          "--overlap", options.overlap,
          "of reference closures, the share of the smaller map's voxels that must be passed")
      ->capture_default_str();
  command
      ->add_option("--overlap-between-sessions", options.overlap_between_sessions,
                   "the same between sessions")
      ->capture_default_str();
  command->add_option("--min-inliers", options.min_inliers, "of the detector's closures counted")
      ->capture_default_str();
  command
      ->add_option("--reference-poses", arguments->reference_poses,
                   "ground-truth, or icp from there where ground truth differs between visits "
                   "(auto: icp unless simulated)")
      ->check(CLI::IsMember({"auto", "ground-truth", "icp"}))
      ->capture_default_str();
  command->add_option("--report", arguments->report,
                      "writes a page with the tables and the precision-recall curve");
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace groundloop::apps
