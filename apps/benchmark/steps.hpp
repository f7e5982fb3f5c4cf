// The work of a suite as steps, each a command that leaves a file: runs, detections, evaluations,
// matches and merges, with what each needs done before. Nothing is run here.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/benchmark/results.hpp"
#include "apps/benchmark/suite.hpp"

namespace groundloop::apps {

/// Where a suite finds its recordings and leaves its results.
struct BenchmarkFolders {
  std::filesystem::path data;  ///< relative paths of recordings start here
  std::filesystem::path out;
  std::filesystem::path programs = {};  ///< {programs} of detectors: where groundloop itself lies
};

struct Step {
  std::string name;        ///< unique, fit for the name of a file
  bool groundloop = true;  ///< a subcommand of groundloop itself, else another program
  std::vector<std::string> command;
  std::vector<std::string> needs;         ///< names of steps
  std::filesystem::path standard_output;  ///< file it goes to; empty: the log
  std::filesystem::path result;           ///< file or folder it leaves
  int memory_mb = 1000;
};

/// What a result of the suite is read from.
struct ResultSource {
  Result result;                            ///< without figures
  std::string step;                         ///< without which there is no result
  std::filesystem::path session;            ///< metrics.json of the session of one recording
  std::filesystem::path metrics, closures;  ///< documents; empty where there is none
  std::string measured_step;                ///< whose processor time and memory count
  bool expected_to_join = true;
};

struct SuitePlan {
  std::vector<Step> steps;  ///< each after those it needs
  std::vector<ResultSource> sources;
  std::vector<Gap> gaps;  ///< recordings that are not there, and pairs of them
};

[[nodiscard]] SuitePlan plan_suite(const Suite& suite, const BenchmarkFolders& folders);

}  // namespace groundloop::apps
