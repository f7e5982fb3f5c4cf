// The measures that tables are made of: what each is called, how it is defined, where its figure
// comes from, and how the figures of several recordings become one. The one list of them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/benchmark/results.hpp"

namespace groundloop::apps {

/// The documents a result is read from; null where there is none.
struct ResultDocuments {
  nlohmann::ordered_json metrics;   ///< metrics.json of the session, or of the merged one
  nlohmann::ordered_json closures;  ///< `evaluate closures --json`
  nlohmann::ordered_json session;   ///< metrics.json of the session, of detectors' rows too
  nlohmann::ordered_json step;      ///< of the runner: processor seconds, memory
  bool expected_to_join = true;     ///< of a pair
};

struct Measure {
  std::string name;     ///< in suites, results.json and CSV
  std::string heading;  ///< with the unit
  int decimals = 3;
  int better = 0;  ///< 1: more, -1: less, 0: neither
  std::string definition;
  /// Of one recording or pair; empty where it has no such figure.
  std::function<std::optional<double>(const ResultDocuments&)> extract;
  enum class Over { mean, sum, pooled } over = Over::mean;
  /// Of several recordings as one, where it is pooled.
  std::function<std::optional<double>(const std::vector<const Detections*>&)> pool;
};

[[nodiscard]] const std::vector<Measure>& measures();
/// Null where there is none of that name.
[[nodiscard]] const Measure* find_measure(std::string_view name);
[[nodiscard]] std::string nearest_measure(std::string_view name);

/// A figure of several results, and how sure it is.
struct Combined {
  std::optional<double> value;
  /// Standard error over the recordings (jackknife); empty where there is one, and for sums.
  std::optional<double> error;
  std::size_t results = 0;  ///< that have it
};
[[nodiscard]] Combined combine(const Measure& measure, const std::vector<const Result*>& results);

/// The difference of two sets of results, recording by recording where both have it: `after` less
/// `before`, and its standard error (jackknife over the recordings that both have).
[[nodiscard]] Combined combine_difference(const Measure& measure,
                                          const std::vector<const Result*>& before,
                                          const std::vector<const Result*>& after);

/// A list of measures under one title.
struct TableKind {
  std::string name, title;
  std::string subject;     ///< "recording" or "pair"
  bool detectors = false;  ///< a row for each detector too
  std::string note;
  std::vector<std::string> columns;
};
[[nodiscard]] const std::vector<TableKind>& table_kinds();
[[nodiscard]] const TableKind* find_table_kind(std::string_view name);

}  // namespace groundloop::apps
