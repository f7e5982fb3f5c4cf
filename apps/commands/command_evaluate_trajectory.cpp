#include <cstdio>
#include <memory>
#include <string>

#include "apps/commands/commands.hpp"
#include "apps/commands/ground_truth.hpp"
#include "apps/report/evaluation_pages.hpp"
#include "apps/report/trajectory_evaluation_json.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  std::string estimate;
  std::string ground_truth;
  std::string truth_frame;
  std::string report;
  bool json = false;
  TrajectoryEvaluationOptions options;
};

void run(Arguments arguments) {
  const GroundTruth estimate = read_ground_truth(arguments.estimate, "sensor");
  const GroundTruth truth = read_ground_truth(arguments.ground_truth, arguments.truth_frame);
  if (estimate.stamped != truth.stamped) {
    throw InputError(arguments.estimate + " and " + arguments.ground_truth +
                     ": one has stamps (TUM, 8 columns) and the other none (KITTI, 12 columns); "
                     "give both in the same form");
  }
  arguments.options.by_row = !estimate.stamped;
  TrajectoryEvaluation evaluation;
  JudgedTruth judged;
  try {
    judged = judge_ground_truth(truth, estimate.poses);
    evaluation = evaluate_trajectory(estimate.poses, judged.poses, arguments.options);
  } catch (const InputError& e) {
    throw InputError(arguments.estimate + ", " + arguments.ground_truth + ": " + e.what());
  }
  log_ground_truth(truth, judged);
  if (!arguments.report.empty()) {
    write_text_atomically(arguments.report,
                          make_page(trajectory_page(arguments.estimate, estimate.poses,
                                                    judged.poses, evaluation, arguments.options)));
  }
  VisitDistances visits = visit_distances(estimate.poses, judged.poses, evaluation.pairs);
  if (!truth.stamped) visits.by_time = {};
  nlohmann::ordered_json json = to_json(evaluation, arguments.options);
  json["visits"] = to_json(visits);
  json["ground_truth"] = to_json(judged.frame);
  const std::string text = arguments.json
                               ? json.dump(2) + "\n"
                               : to_table(evaluation, arguments.options) + to_table(visits);
  std::fputs(text.c_str(), stdout);
}

}  // namespace

void add_evaluate_trajectory_command(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand(
      "trajectory", "errors of a trajectory against ground truth (TUM or KITTI files)");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--estimate", arguments->estimate, "trajectory to judge")->required();
  command->add_option("--ground-truth", arguments->ground_truth, "trajectory taken as true")
      ->required();
  command->add_option("--truth-frame", arguments->truth_frame,
                      "what the poses of the ground truth are of: sensor, camera (by calib.txt), "
                      "or a file with T_truth_sensor as a 4x4 matrix");
  command
      ->add_option("--align", arguments->options.alignment,
                   "none, origin (first poses coincide), se3 (Umeyama) or sim3 (with scale)")
      ->check(CLI::IsMember({"none", "origin", "se3", "sim3"}))
      ->capture_default_str();
  command->add_option("--tolerance", arguments->options.tolerance, "of paired stamps, seconds")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->add_option("--report", arguments->report, "page to write (.html)");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace groundloop::apps
