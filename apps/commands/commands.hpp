// The subcommands of `groundloop`. Each adds itself to the command line and does its work in a
// callback; errors travel as exceptions to run_command_line, which turns them into one line and an
// exit code.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace groundloop::apps {

/// What every subcommand shares.
struct Context {
  bool quiet = false;
  bool verbose = false;
  int threads = 0;  ///< 0: all cores
  /// What is said after Ctrl-C: what was left, and how to go on.
  std::string after_interruption = "nothing was written";
};

void add_run_command(CLI::App& app, Context& context);
void add_demo_command(CLI::App& app, Context& context);
void add_export_command(CLI::App& app, Context& context);
void add_merge_command(CLI::App& app, Context& context);
void add_match_command(CLI::App& app, Context& context);
void add_report_command(CLI::App& app, Context& context);
void add_compare_command(CLI::App& app, Context& context);
void add_doctor_command(CLI::App& app, Context& context);
void add_benchmark_command(CLI::App& app, Context& context);
void add_config_command(CLI::App& app, Context& context);
/// The group `evaluate`, on which its subcommands hang.
void add_evaluate_command(CLI::App& app, Context& context);
void add_evaluate_trajectory_command(CLI::App& evaluate, Context& context);
void add_evaluate_closures_command(CLI::App& evaluate, Context& context);
void add_evaluate_map_command(CLI::App& evaluate, Context& context);

/// Everything that the command line knows, without parsing a word of it.
void add_commands(CLI::App& app, Context& context);

/// Runs the command line; returns the exit code: 0, 1 (failed internal check), 2 (bad input or
/// usage), 130 (interrupted).
int run_command_line(int argc, const char* const* argv);

void add_inspect_command(CLI::App& app, Context& context);
void add_simulate_command(CLI::App& app, Context& context);
void add_optimize_command(CLI::App& app, Context& context);
/// What makes shells complete the words of the whole command line.
void add_completion_command(CLI::App& app);
/// Manual pages of all commands; not listed, the build calls it.
void add_man_command(CLI::App& app);

}  // namespace groundloop::apps
