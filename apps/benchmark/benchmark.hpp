// A whole benchmark: plans a suite, runs what is not done, and leaves results.json, tables and a
// report in its folder. What `groundloop benchmark` does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/benchmark/step_runner.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop::apps {

struct BenchmarkRequest {
  std::string suite;           ///< file, or the name of one that is built in
  std::filesystem::path data;  ///< folder that relative paths of recordings start from
  StepRunnerOptions runner;
  std::string command_line;  ///< stated in the report
};

struct BenchmarkSummary {
  std::size_t steps = 0, done = 0;
  std::vector<StepOutcome> failures;  ///< failed, not those that wait for them
  std::vector<Gap> missing;           ///< recordings that are not there
};

/// Names of all steps, in an order in which they can be run, those that are done marked.
[[nodiscard]] std::string list_steps(const BenchmarkRequest& request);

/// One line of JSON: {"steps": [{"name", "needs", "memory_mb"}]}, for a scheduler.
[[nodiscard]] std::string steps_as_json(const BenchmarkRequest& request);

/// Runs request.runner.step alone and makes no tables: what a scheduler's job does. Throws
/// InputError where there is no such step.
[[nodiscard]] StepOutcome run_one_step(const BenchmarkRequest& request, const Progress& progress);

/// Throws InputError where the suite is no suite, or the folder holds something else.
[[nodiscard]] BenchmarkSummary run_benchmark(const BenchmarkRequest& request,
                                             const Progress& progress);

/// results.json of two folders row by row, as Markdown.
[[nodiscard]] std::string compare_folders(const std::filesystem::path& before,
                                          const std::filesystem::path& after);

}  // namespace groundloop::apps
