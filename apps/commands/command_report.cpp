// `groundloop report SESSION`: the page of a finished session, made anew from its files.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/commands/commands.hpp"
#include "apps/commands/ground_truth.hpp"
#include "apps/report/session_report.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::string session, out, truth_frame;
  std::vector<std::string> ground_truth;
  int points = -1, closures = -1;
};

// By recordings: FILE, or NAME=FILE in a session of several.
std::map<std::string, fs::path> by_recording(const SessionContents& contents,
                                             const std::vector<std::string>& texts) {
  const std::vector<SessionPart>& parts = contents.session.parts;
  std::map<std::string, fs::path> files;
  if (!contents.merged()) {
    if (texts.size() > 1)
      throw InputError("--ground-truth is given twice; the session holds one recording");
    if (!texts.empty()) files[parts.front().name] = texts.front();
    return files;
  }
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const bool known = std::any_of(parts.begin(), parts.end(),
                                   [&](const SessionPart& part) { return part.name == name; });
    if (!known || equals == std::string::npos)
      throw InputError("--ground-truth " + text +
                       ": expected NAME=FILE, NAME of a recording of the session");
    files[name] = text.substr(equals + 1);
  }
  return files;
}

void run(const Arguments& arguments) {
  SessionContents contents = read_session_contents(arguments.session);
  const auto files = by_recording(contents, arguments.ground_truth);
  if (arguments.points >= 0) contents.config.report.points = arguments.points;
  if (arguments.closures >= 0) contents.config.report.closures = arguments.closures;
  const std::vector<Trajectory> truths =
      true_trajectories(contents.session, files, arguments.truth_frame);
  const fs::path out =
      arguments.out.empty() ? contents.session.folder.file("report.html") : fs::path(arguments.out);
  write_text_atomically(out, make_session_report(contents, truths));
  spdlog::info("report: {}", out.string());
}

}  // namespace

void add_report_command(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand(
      "report", "the page of a finished session, made anew: report.html in its folder, or --out");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SESSION", arguments->session, "folder that `run` or `merge` left")
      ->required();
  command->add_option("--out", arguments->out, "file to write instead of SESSION/report.html");
  command
      ->add_option("--ground-truth", arguments->ground_truth,
                   "trajectory to compare with: FILE, or NAME=FILE for a recording of a merged "
                   "session; without it, what came with the recording")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--truth-frame", arguments->truth_frame,
                      "what the poses of the ground truth are of: sensor, camera or a file");
  command->add_option("--points", arguments->points, "of the 3-D view, instead of report.points")
      ->check(CLI::Range(0, 10'000'000));
  command
      ->add_option("--closures", arguments->closures, "shown in detail, instead of report.closures")
      ->check(CLI::Range(0, 100'000));
  command->callback([arguments] { run(*arguments); });
}

}  // namespace groundloop::apps
