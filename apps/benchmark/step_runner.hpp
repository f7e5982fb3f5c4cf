// Runs the steps of a suite as processes, several at a time as memory allows, each once: what is
// done is stamped, and a step is done again only where its command or something it needs has
// changed. Interrupted or failed steps are tried again by the next call.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/benchmark/steps.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop::apps {

struct StepRunnerOptions {
  std::filesystem::path groundloop;  ///< the command itself
  std::filesystem::path out;         ///< stamps, logs and results lie in it
  int jobs = 1;                      ///< steps at a time
  int threads = 0;                   ///< --threads of each; 0: its own choice
  int memory_mb = 0;                 ///< for all that run at a time; 0: what is free at the start
  std::vector<std::string> only;     ///< patterns of steps; those they need are run too
  std::string step;  ///< this one alone; what it needs is done already, or it is blocked
};

struct StepOutcome {
  std::string name;
  enum class State { done, failed, blocked } state = State::done;
  std::string why;  ///< of a failure: the last line of its log, or the step it waits for
};

/// Where the stamp of a step lies: a JSON object with its command, exit code, seconds,
/// processor_seconds and peak_memory_mb.
[[nodiscard]] std::filesystem::path step_stamp(const std::filesystem::path& out,
                                               const std::string& step);

/// Whether a step's stamp says that it succeeded, with this command and these needs.
[[nodiscard]] bool is_done(const std::vector<Step>& steps, const Step& step,
                           const std::filesystem::path& out);

/// Runs what is not done. Where `progress` throws, running steps are stopped before it travels on.
[[nodiscard]] std::vector<StepOutcome> run_steps(const std::vector<Step>& steps,
                                                 const StepRunnerOptions& options,
                                                 const Progress& progress);

}  // namespace groundloop::apps
