#include <cstdio>
#include <memory>
#include <string>

#include <spdlog/spdlog.h>

#include "apps/commands/closure_evaluation_documents.hpp"
#include "apps/commands/closure_list.hpp"
#include "apps/commands/commands.hpp"
#include "apps/commands/evaluated_sessions.hpp"
#include "apps/commands/progress_bar.hpp"
#include "apps/commands/reference_file.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> sessions;
  std::vector<std::string> recordings, ground_truths;
  std::string truth_frame;
  std::string reference_poses = "truth";
  std::string references, list, report;
  bool json = false;
  ClosureEvaluationOptions options;
};

// Overlaps from the file that keeps them, or computed and kept there.
std::vector<PairOverlap> overlaps(const Arguments& arguments,
                                  const std::vector<EvaluatedPart>& parts,
                                  std::vector<EvaluatedMap>& maps, const Progress& progress) {
  const ReferenceOptions& options = arguments.options.references;
  const std::uint64_t fingerprint = reference_fingerprint(parts, maps, options);
  if (!arguments.references.empty()) {
    if (auto known = read_references(arguments.references, parts, fingerprint)) return *known;
  }
  rebuild_points(parts, maps, progress);
  std::vector<PairOverlap> pairs = overlapping_pairs(maps, options, progress);
  if (!arguments.references.empty()) {
    write_references(arguments.references, parts, pairs, options, fingerprint);
  }
  return pairs;
}

void print(const PageTable& table) {
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

void write_page(const Arguments& arguments, const ClosureEvaluation& evaluation,
                const std::vector<PageTable>& tables) {
  Page page;
  page.title = "Closures of " + SessionFolder(arguments.sessions.front()).name();
  page.tables = tables;
  PagePlot plot{"Precision and recall of the detector", "", "least score", "share", true, {}};
  std::vector<double> thresholds;
  std::vector<double> precision;
  std::vector<double> recall;
  for (const PrecisionRecallPoint& p : evaluation.detector.curve) {
    thresholds.push_back(p.threshold);
    precision.push_back(p.precision);
    recall.push_back(p.recall);
  }
  plot.series = {{"precision", "after", thresholds, precision},
                 {"recall", "before", thresholds, recall}};
  page.json["plots"] = {to_json(plot)};
  write_text_atomically(arguments.report, make_page(std::move(page)));
}

void run(Arguments& arguments, const Context& context) {
  ClosureEvaluationOptions& options = arguments.options;
  options.references.align = arguments.reference_poses == "icp";
  if (arguments.sessions.size() > 1) {
    if (arguments.list.empty()) {
      throw InputError(
          "evaluate closures: of two sessions only a list can be evaluated; give --closures FILE, "
          "e.g. of `groundloop match`");
    }
    options.references.pairs = "between";
  }
  validate(options, "evaluate closures");
  validate(options.references, "evaluate closures");
  const Progress progress = make_progress(context);
  const std::vector<EvaluatedPart> parts = read_parts(
      arguments.sessions, arguments.recordings, arguments.ground_truths, arguments.truth_frame);
  const std::vector<ReportedClosure> closures =
      arguments.list.empty() ? session_closures(parts) : read_closure_list(arguments.list, parts);
  EvaluatedSessions evaluated = evaluated_sessions(parts);
  const std::vector<PairOverlap> pairs = overlaps(arguments, parts, evaluated.maps, progress);
  const ClosureEvaluation evaluation = evaluate_closures(
      evaluated.maps, pairs, closures, [&](const MapKey& key) { return own_points(parts, key); },
      options, progress);
  end_progress();
  if (evaluation.dropped > 0) {
    evaluated.notes.push_back(std::to_string(evaluation.dropped) +
                              " reported pairs are not eligible and were left out");
  }
  for (const std::string& note : evaluated.notes) spdlog::warn("{}", note);
  const std::vector<PageTable> tables = closure_evaluation_tables(evaluation, options);
  if (!arguments.report.empty()) write_page(arguments, evaluation, tables);
  if (arguments.json) {
    std::printf("%s\n",
                closure_evaluation_json(evaluation, options, evaluated.notes).dump(2).c_str());
  } else {
    for (const PageTable& table : tables) print(table);
  }
}

void add_definition_options(CLI::App& command, ClosureEvaluationOptions& options) {
  command
      .add_option(
          "--overlap", options.references.overlap,
          "of reference closures, the share of the smaller map's voxels that must be passed")
      ->capture_default_str();
  command
      .add_option("--overlap-between-sessions", options.references.overlap_between_sessions,
                  "the same between sessions")
      ->capture_default_str();
  command
      .add_option("--threshold,--min-inliers", options.threshold,
                  "score (inliers) from which a closure is counted as detected")
      ->capture_default_str();
  command
      .add_option("--pairs", options.references.pairs,
                  "of a merged session: all, within or between its recordings")
      ->check(CLI::IsMember({"all", "within", "between"}))
      ->capture_default_str();
}

}  // namespace

void add_evaluate_closures_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "closures",
      "precision, recall and alignment of closures against ground truth: a session's, or any "
      "detector's");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("SESSION", arguments->sessions,
                   "session folder, of one recording or merged; or two, for closures between them")
      ->required()
      ->expected(1, 2);
  command->add_option(
      "--closures", arguments->list,
      "CSV of pairs of maps or scans with or without score and pose, instead of the "
      "session's own");
  command
      ->add_option("--recording", arguments->recordings,
                   "recording to rebuild reference maps from, one a session (default: the "
                   "manifest's)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      ->add_option("--ground-truth", arguments->ground_truths,
                   "trajectory taken as true, one a session (default: the recording's)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--truth-frame", arguments->truth_frame,
                      "whose poses given ground truth holds: sensor, camera, or a file with the "
                      "sensor's pose in that body (default: judged by the odometry)");
  command
      ->add_option("--reference-poses", arguments->reference_poses,
                   "truth, as the paper has it, or icp from there where ground truth differs "
                   "between visits")
      ->check(CLI::IsMember({"truth", "icp"}))
      ->capture_default_str();
  command->add_option("--references", arguments->references,
                      "CSV that keeps the overlaps of maps: read if it is of these maps, else "
                      "written");
  add_definition_options(*command, arguments->options);
  command->add_option("--report", arguments->report,
                      "writes a page with the tables and the precision-recall curve");
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace groundloop::apps
