// What a suite came to: one result for each recording or pair of recordings, configuration and
// detector, with its figures. Kept as results.json, from which tables, report and comparisons are
// made without running anything again.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "loopclosure/evaluation/precision_recall.hpp"

namespace groundloop::apps {

/// A closure that was reported, as `groundloop evaluate closures` judges it.
struct JudgedClosure {
  double score = 0.0;
  bool correct = false;     ///< its pair is a reference closure
  bool uncertain = false;   ///< whose overlap is near the threshold
  bool right_pose = false;  ///< its pose is right where the maps meet
};

/// All closures a detector reported on one recording or pair, and what there was to find.
struct Detections {
  std::size_t references = 0;  ///< reference closures
  std::size_t uncertain = 0;   ///< of them, those near the threshold
  std::size_t eligible = 0;    ///< pairs of maps that could have been reported
  bool poses = true;           ///< whether any comes with a pose: else none can be right
  std::vector<JudgedClosure> closures;
};

enum class Counting {
  all,             ///< a closure is true where its pair is a reference closure
  certain,         ///< likewise, pairs with an overlap near the threshold left out on both sides
  with_right_pose  ///< only where its pose is right as well
};

/// The curve of several recordings as one: scores of all on one scale.
[[nodiscard]] PrecisionRecall pooled_curve(const std::vector<const Detections*>& detections,
                                           Counting counting);

/// One cell of recordings times configurations times detectors.
struct Result {
  std::string kind;  ///< "recording" or "pair"
  std::string subject, group;
  std::string configuration;              ///< of the sessions
  std::string detector;                   ///< empty: the run's own closures
  std::string repetition;                 ///< of configuration and detector
  std::string references;                 ///< poses that reference closures come from: truth, icp
  std::map<std::string, double> figures;  ///< by the measures' names
  std::optional<Detections> detections;
};

/// Something that was to be run and could not be.
struct Gap {
  std::string what, why;
};

struct Results {
  std::string title;
  std::vector<std::pair<std::string, std::string>> made;  ///< version, machine, date, command
  std::vector<Result> results;
  std::vector<Gap> gaps;
};

void write_results(const std::filesystem::path& file, const Results& results);
/// Throws InputError where the file is damaged or of another version.
[[nodiscard]] Results read_results(const std::filesystem::path& file);

}  // namespace groundloop::apps
