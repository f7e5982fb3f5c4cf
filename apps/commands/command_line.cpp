#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "apps/cli/help_text.hpp"
#include "apps/commands/commands.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"
#include "frontend/core/spelling.hpp"

namespace groundloop::apps {
namespace {

void set_up_logging(const Context& context) {
  auto logger = spdlog::get("groundloop");
  if (!logger) logger = spdlog::stderr_logger_mt("groundloop");
  logger->set_pattern("%^%l%$: %v");
  logger->set_level(context.quiet     ? spdlog::level::warn
                    : context.verbose ? spdlog::level::debug
                                      : spdlog::level::info);
  spdlog::set_default_logger(logger);
}

// The message as one line on standard error.
void print_error(const char* what) {
  std::string line(what);
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::fprintf(stderr, "groundloop: %s\n", line.c_str());
}

std::vector<const CLI::App*> parsed_subcommands(const CLI::App& app) {
  std::vector<const CLI::App*> parsed;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    if (command->parsed()) parsed.push_back(command);
  }
  return parsed;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    if (!command->get_group().empty()) names.push_back(command->get_name());
  }
  return names;
}

// Of a command and, since they may follow it, of those around it.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command = &app; command != nullptr; command = command->get_parent()) {
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

// The command whose words are being parsed: the innermost one that was named.
const CLI::App& innermost(const CLI::App& app) {
  const std::vector<const CLI::App*> named = parsed_subcommands(app);
  return named.empty() ? app : innermost(*named.front());
}

// What is wrong with the words of the command line: the word that is refused, and the nearest that
// exists where one is near.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  const std::vector<std::string> words = app.remaining(true);
  std::string path;
  for (const CLI::App* part = &command; part != nullptr; part = part->get_parent())
    path.insert(0, part->get_name() + " ");
  const std::string help = "; see " + path + "--help";
  if (words.empty()) return error.what() + help;
  const std::string& word = words.front();
  if (word.front() == '-') {
    const std::string name = word.substr(0, word.find('='));
    return "unknown option '" + name + "'" + suggestion(name, option_names(command)) + help;
  }
  if (const std::vector<std::string> known = command_names(command); !known.empty()) {
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
    return "unknown command '" + word + "'" + suggestion(word, known) + "; commands are " + list;
  }
  return "'" + word + "' is one word too many" + help;
}

}  // namespace

void add_commands(CLI::App& app, Context& context) {
  app.description(
      "offline LiDAR SLAM for recorded sequences: odometry, loop closing, pose graph, map");
  app.name("groundloop");
  // Taken over by every subcommand as it is added.
  app.formatter(help_formatter());
  app.set_help_flag("-h,--help", "print this and exit");
  app.set_version_flag("--version", std::string("groundloop " GROUNDLOOP_VERSION),
                       "print the version and exit");
  app.add_flag("--quiet", context.quiet, "only warnings and errors");
  app.add_flag("--verbose", context.verbose, "more detail");
  app.add_option("--threads", context.threads, "threads to use (0: all cores)")
      ->check(CLI::Range(0, 1024));
  app.require_subcommand(1);
  app.fallthrough();
  add_run_command(app, context);
  add_demo_command(app, context);
  add_inspect_command(app, context);
  add_merge_command(app, context);
  add_match_command(app, context);
  add_export_command(app, context);
  add_report_command(app, context);
  add_doctor_command(app, context);
  add_compare_command(app, context);
  add_evaluate_command(app, context);
  add_optimize_command(app, context);
  add_simulate_command(app, context);
  add_benchmark_command(app, context);
  add_config_command(app, context);
  add_completion_command(app);
  add_man_command(app);
}

int run_command_line(int argc, const char* const* argv) {
  Context context;
  CLI::App app;
  add_commands(app, context);
  // Subcommands run in their callbacks, after this.
  app.parse_complete_callback([&] {
    set_up_logging(context);
    set_thread_count(context.threads);
  });
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    print_error(usage_error(app, e).c_str());
    return 2;
  } catch (const InputError& e) {
    print_error(e.what());
    return 2;
  } catch (const Interrupted&) {
    print_error(("interrupted; " + context.after_interruption).c_str());
    return 130;
  } catch (const std::bad_alloc&) {
    print_error("memory ran out; close other programs, or use a machine that has more");
    return 2;
  } catch (const std::exception& e) {
    print_error(e.what());
    return 1;
  }
}

}  // namespace groundloop::apps
