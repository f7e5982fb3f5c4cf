// A benchmark suite: recordings, pairs of them, configurations and detectors, and the tables to
// make of what comes out. Read from YAML; lists that differ in a word only are written once, with
// `for: {word: [values]}` and {word} where it goes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace groundloop::apps {

struct SuiteRecording {
  std::string name;   ///< of this recording alone
  std::string group;  ///< recordings of one group share a row of the tables
  std::string path;   ///< file, folder or sim:...; relative to the data folder
  std::string format, topic, ground_truth;
  std::string truth_frame;  ///< what `groundloop run --truth-frame` takes; a file lies in the data
  std::vector<std::string> options;     ///< further ones of `groundloop run`
  std::vector<std::string> needs;       ///< files and folders without which it is left out
  std::vector<std::string> references;  ///< poses that reference closures come from: truth, icp
  int memory_mb = 2000;                 ///< what one run of it may take
};

/// Two recordings, matched and merged.
struct SuitePair {
  std::string name, group, reference, query;
  bool overlap = true;  ///< whether they share any place: whether they should be joined
  bool merge = true;    ///< else they are only matched
};

struct SuiteConfiguration {
  std::string name;        ///< of the row
  std::string repetition;  ///< tells runs of one name apart: "seed=1"; empty where there is one
  std::string preset;      ///< a preset or a file; empty: the defaults
  std::vector<std::string> settings;  ///< KEY=VALUE
  std::vector<std::string> groups;    ///< patterns of groups it is run on; empty: all
};

/// What finds closures on sessions that are there: another program, or groundloop's own detector
/// with another configuration.
struct SuiteDetector {
  std::string name;        ///< of the row
  std::string repetition;  ///< as a configuration's
  /// The program and its arguments; {session}, {reference}, {query} and {out} stand for the
  /// sessions' folders and the list to write, {programs} for the folder of groundloop itself.
  /// Empty: groundloop's own detector, `preset` and `settings` over the configuration of the
  /// session.
  std::vector<std::string> command, pair_command;
  std::string preset;
  std::vector<std::string> settings;
  std::vector<std::string> configurations;  ///< patterns of those whose sessions it reads
  std::vector<std::string> groups;          ///< patterns; empty: all
  [[nodiscard]] bool own() const { return command.empty() && pair_command.empty(); }
};

struct SuiteTable {
  std::string title;
  std::string kind;                  ///< names a list of measures (measures.hpp) and what a row is
  std::vector<std::string> columns;  ///< measures instead of the kind's
  std::vector<std::string> groups, configurations;  ///< patterns, in the order wanted; empty: all
  bool groups_across = false;  ///< groups side by side and a row a configuration, as papers do
  bool by_recording = false;   ///< a row each recording under that of its group
};

struct Suite {
  std::string title;
  std::filesystem::path file;
  std::vector<SuiteRecording> recordings;
  std::vector<SuitePair> pairs;
  std::vector<SuiteConfiguration> configurations;
  std::vector<SuiteDetector> detectors;
  std::vector<SuiteTable> tables;
};

/// Reads a suite from a file, or one that is built in by its name. Throws InputError naming file,
/// line and the nearest known key; also where a name is used twice or means nothing.
[[nodiscard]] Suite read_suite(const std::string& file_or_name);

/// Names of the suites that are built in.
[[nodiscard]] std::vector<std::string> suite_names();

/// Whether a name fits one of the patterns of a shell (`town*`), or there is none.
[[nodiscard]] bool fits_any(const std::string& name, const std::vector<std::string>& patterns);

}  // namespace groundloop::apps
