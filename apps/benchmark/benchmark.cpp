#include "apps/benchmark/benchmark.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "apps/benchmark/benchmark_documents.hpp"
#include "apps/benchmark/collect.hpp"
#include "apps/benchmark/suite_tables.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;

SuitePlan plan_of(const BenchmarkRequest& request, const Suite& suite) {
  return plan_suite(suite,
                    {request.data, request.runner.out, request.runner.groundloop.parent_path()});
}

// A folder of results is made here, or by an earlier call.
void prepare_folder(const fs::path& out) {
  std::error_code error;
  if (fs::exists(out) && !fs::is_directory(out)) {
    throw InputError(out.string() + ": is no folder; choose another --out");
  }
  if (fs::exists(out) && !fs::is_empty(out, error) && !fs::exists(out / "steps")) {
    throw InputError(out.string() +
                     ": holds files that are no results of a benchmark; choose another --out");
  }
  fs::create_directories(out / "steps", error);
  if (error) {
    throw InputError(out.string() + ": cannot be written: " + error.message() +
                     "; choose another --out");
  }
}

}  // namespace

std::string list_steps(const BenchmarkRequest& request) {
  const SuitePlan plan = plan_of(request, read_suite(request.suite));
  std::string text;
  for (const Step& step : plan.steps) {
    text +=
        (is_done(plan.steps, step, request.runner.out) ? "done  " : "open  ") + step.name + "\n";
  }
  for (const Gap& gap : plan.gaps) text += "left out: " + gap.what + ": " + gap.why + "\n";
  return text;
}

std::string steps_as_json(const BenchmarkRequest& request) {
  const SuitePlan plan = plan_of(request, read_suite(request.suite));
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  for (const Step& step : plan.steps) {
    steps.push_back({{"name", step.name}, {"needs", step.needs}, {"memory_mb", step.memory_mb}});
  }
  return nlohmann::ordered_json{{"steps", steps}}.dump();
}

StepOutcome run_one_step(const BenchmarkRequest& request, const Progress& progress) {
  const SuitePlan plan = plan_of(request, read_suite(request.suite));
  const bool known = std::any_of(plan.steps.begin(), plan.steps.end(), [&](const Step& step) {
    return step.name == request.runner.step;
  });
  if (!known) {
    throw InputError("--step " + request.runner.step + ": " + request.suite +
                     " has no such step; --list names them");
  }
  prepare_folder(request.runner.out);
  return run_steps(plan.steps, request.runner, progress).front();
}

BenchmarkSummary run_benchmark(const BenchmarkRequest& request, const Progress& progress) {
  const Suite suite = read_suite(request.suite);
  const SuitePlan plan = plan_of(request, suite);
  prepare_folder(request.runner.out);
  BenchmarkSummary summary;
  summary.missing = plan.gaps;
  for (const Gap& gap : plan.gaps) spdlog::warn("left out: {}: {}", gap.what, gap.why);
  for (const StepOutcome& outcome : run_steps(plan.steps, request.runner, progress)) {
    ++summary.steps;
    summary.done += outcome.state == StepOutcome::State::done ? 1 : 0;
    if (outcome.state == StepOutcome::State::failed) summary.failures.push_back(outcome);
  }
  Results results = collect_results(suite, plan, request.runner.out);
  results.made = made_by(request.command_line);
  write_benchmark_documents(suite, results, request.runner.out);
  return summary;
}

std::string compare_folders(const fs::path& before, const fs::path& after) {
  const Results a = read_results(before / "results.json");
  const Results b = read_results(after / "results.json");
  std::string text = "# " + b.title + ": compared\n\n";
  for (const auto& [name, results] : {std::pair("before", &a), std::pair("after", &b)}) {
    text += std::string("- ") + name + ":";
    for (const auto& [key, value] : results->made) text += " " + key + " " + value + ";";
    text.back() = '\n';
  }
  const std::vector<Table> tables = compare_results(a, b);
  if (tables.empty()) {
    throw InputError(after.string() + ": no row in common with " + before.string() +
                     "; compare results of the same suite");
  }
  for (const Table& table : tables) text += "\n" + to_markdown(table);
  return text;
}

}  // namespace groundloop::apps
