#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/benchmark/benchmark.hpp"
#include "apps/commands/commands.hpp"
#include "apps/commands/progress_bar.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  BenchmarkRequest request;
  std::vector<std::string> compare;
  bool list = false, steps = false;
};

std::string command_line_of(const BenchmarkRequest& request) {
  std::string text =
      "groundloop benchmark " + request.suite + " --out " + request.runner.out.string();
  if (!request.data.empty()) text += " --data " + request.data.string();
  for (const std::string& pattern : request.runner.only) text += " --only '" + pattern + "'";
  return text;
}

void run(Arguments& arguments, const Context& context) {
  BenchmarkRequest& request = arguments.request;
  if (!arguments.compare.empty()) {
    std::fputs(compare_folders(arguments.compare[0], arguments.compare[1]).c_str(), stdout);
    return;
  }
  if (request.suite.empty() || request.runner.out.empty()) {
    throw InputError("benchmark: a suite and --out are needed, or --compare BEFORE AFTER");
  }
  StepRunnerOptions& runner = request.runner;
  runner.groundloop = std::filesystem::read_symlink("/proc/self/exe");
  runner.threads = context.threads;
  request.command_line = command_line_of(request);
  if (arguments.list || arguments.steps) {
    std::fputs((arguments.list ? list_steps(request) : steps_as_json(request) + "\n").c_str(),
               stdout);
    return;
  }
  stop_on_signals();
  if (!runner.step.empty()) {
    const StepOutcome outcome = run_one_step(request, make_progress(context));
    end_progress();
    if (outcome.state == StepOutcome::State::done) return;
    throw std::runtime_error(
        outcome.name + ": " +
        (outcome.state == StepOutcome::State::failed ? "" : "it needs first ") + outcome.why);
  }
  const BenchmarkSummary summary = run_benchmark(request, make_progress(context));
  end_progress();
  spdlog::info("{} of {} steps done, {} recordings or pairs not there; {}", summary.done,
               summary.steps, summary.missing.size(), (runner.out / "report.md").string());
  if (summary.failures.empty()) return;
  std::string names;
  for (const StepOutcome& failure : summary.failures) {
    names += (names.empty() ? "" : "; ") + failure.name + ": " + failure.why;
  }
  throw std::runtime_error(std::to_string(summary.failures.size()) + " of " +
                           std::to_string(summary.steps) + " steps failed: " + names);
}

}  // namespace

void add_benchmark_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "benchmark", "runs a suite of recordings and configurations, and makes tables of it");
  auto arguments = std::make_shared<Arguments>();
  BenchmarkRequest& request = arguments->request;
  StepRunnerOptions& runner = request.runner;
  // Two steps of two threads each keep four cores busy; what runs at a time is bounded by memory.
  runner.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / 2);
  std::string names;
  for (const std::string& name : suite_names()) names += (names.empty() ? "" : ", ") + name;
  command->add_option("SUITE", request.suite, "YAML file, or one of " + names);
  command->add_option("--out", runner.out,
                      "folder of sessions, results, tables and report; what is done in it is not "
                      "done again");
  command->add_option("--data", request.data,
                      "folder that the suite's relative paths start from (the current one)");
  command->add_option("--jobs", runner.jobs, "steps at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--memory", runner.memory_mb,
                      "MB that steps may take together, by the suite's estimates (what is free)");
  command
      ->add_option("--only", runner.only,
                   "pattern of steps (--list), with those they need; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--step", runner.step,
                      "runs this step alone and makes no tables, as a scheduler's job does");
  command->add_flag("--list", arguments->list, "prints the steps and runs none");
  command->add_flag("--steps", arguments->steps, "prints them as JSON, for a scheduler");
  command
      ->add_option("--compare", arguments->compare,
                   "BEFORE AFTER: two folders of results row by row, as Markdown")
      ->expected(2);
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace groundloop::apps
