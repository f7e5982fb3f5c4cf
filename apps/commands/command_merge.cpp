#include <memory>
#include <utility>

#include "apps/commands/commands.hpp"
#include "apps/commands/merge.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  MergeRequest merge;
  MatchRequest match;
  std::vector<std::string> ground_truth;
  std::string config_file;
  std::vector<std::string> settings;
};

void add_config_options(CLI::App& command, Arguments& arguments) {
  command.add_option("--config", arguments.config_file, "YAML file or preset");
  command.add_option("--set", arguments.settings, "KEY=VALUE; may be repeated")->take_all();
}

std::map<std::string, std::filesystem::path> by_name(const std::vector<std::string>& texts) {
  std::map<std::string, std::filesystem::path> files;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError("--ground-truth " + text + ": expected NAME=FILE, NAME of a session");
    files[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return files;
}

}  // namespace

void add_merge_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("merge", "several sessions in one frame, solved together");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("SESSION", arguments->merge.sessions,
                   "folders that `run` or `merge` left; the first is the reference")
      ->required();
  command->add_option("--out", arguments->merge.out, "folder of the merged session")->required();
  command->add_flag("--resume", arguments->merge.resume,
                    "go on with the unfinished merge in the folder");
  command->add_flag("--overwrite", arguments->merge.overwrite,
                    "replace the session in the folder, once the new one is complete");
  command->add_option("--fix", arguments->merge.fixed,
                      "session to hold as the reference map, one of those named");
  command
      ->add_option("--matches", arguments->merge.matches,
                   "file of `groundloop match`, used instead of matching its pair; may be repeated")
      ->take_all()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      ->add_option("--ground-truth", arguments->ground_truth,
                   "NAME=FILE, trajectory to compare session NAME with; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_config_options(*command, *arguments);
  command->callback([arguments, &context] {
    arguments->merge.ground_truth = by_name(arguments->ground_truth);
    arguments->merge.config = effective_config(arguments->config_file, arguments->settings);
    merge_recordings(arguments->merge, context);
  });
}

void add_match_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "match",
      "closures between two sessions, as a file that `merge --matches` takes; of one session, "
      "those within it");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("REFERENCE", arguments->match.reference, "session folder")->required();
  command->add_option("QUERY", arguments->match.query, "session folder, none: REFERENCE itself");
  command->add_option("--out", arguments->match.out, "file to write")->required();
  command->add_flag("--anew", arguments->match.anew,
                    "describe the local maps anew, with this configuration");
  add_config_options(*command, *arguments);
  command->callback([arguments, &context] {
    arguments->match.config = effective_config(arguments->config_file, arguments->settings);
    match_recordings(arguments->match, context);
  });
}

}  // namespace groundloop::apps
