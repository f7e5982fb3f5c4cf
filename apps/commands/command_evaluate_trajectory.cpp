#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "apps/commands/commands.hpp"
#include "apps/report/trajectory_evaluation_json.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  std::string estimate;
  std::string ground_truth;
  bool json = false;
  TrajectoryEvaluationOptions options;
};

// Columns of the first line that is neither empty nor a comment.
int count_columns(const std::string& file) {
  const std::string text = read_text(file);
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line(text.data() + begin, end - begin);
    begin = end + 1;
    int columns = 0;
    bool inside = false;
    for (const char c : line) {
      const bool space = c == ' ' || c == '\t' || c == '\r' || c == ',';
      if (!space && !inside) ++columns;
      inside = !space;
    }
    if (columns > 0 && line[line.find_first_not_of(" \t\r,")] != '#') return columns;
  }
  throw InputError(file + ": holds no pose");
}

// Reads either form and tells whether it has stamps.
Trajectory read_trajectory(const std::string& file, bool& stamped) {
  const int columns = count_columns(file);
  if (columns != 8 && columns != 12) {
    throw InputError(file + ": " + std::to_string(columns) +
                     " columns; a trajectory has 8 (TUM: stamp tx ty tz qx qy qz qw) or 12 (KITTI: "
                     "3x4 matrix)");
  }
  stamped = columns == 8;
  if (stamped) return read_tum(file);
  Trajectory trajectory;
  for (const Pose& pose : read_kitti_poses(file)) trajectory.push_back({0, pose});
  return trajectory;
}

void run(Arguments arguments) {
  bool estimate_stamped = false;
  bool truth_stamped = false;
  const Trajectory estimate = read_trajectory(arguments.estimate, estimate_stamped);
  const Trajectory truth = read_trajectory(arguments.ground_truth, truth_stamped);
  if (estimate_stamped != truth_stamped) {
    throw InputError(arguments.estimate + " and " + arguments.ground_truth +
                     ": one has stamps (TUM, 8 columns) and the other none (KITTI, 12 columns); "
                     "give both in the same form");
  }
  arguments.options.by_row = !estimate_stamped;
  TrajectoryEvaluation evaluation;
  try {
    evaluation = evaluate_trajectory(estimate, truth, arguments.options);
  } catch (const InputError& e) {
    throw InputError(arguments.estimate + ", " + arguments.ground_truth + ": " + e.what());
  }
  const std::string text = arguments.json ? to_json(evaluation, arguments.options).dump(2) + "\n"
                                          : to_table(evaluation, arguments.options);
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
  command
      ->add_option("--align", arguments->options.alignment,
                   "none, origin (first poses coincide), se3 (Umeyama) or sim3 (with scale)")
      ->check(CLI::IsMember({"none", "origin", "se3", "sim3"}))
      ->capture_default_str();
  command->add_option("--tolerance", arguments->options.tolerance, "of paired stamps, seconds")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace groundloop::apps
