// The report is part of a run's time and memory, yet it shows metrics.json: that is written before
// the report without its cost, and after it with it. The page shows the figures without it, which
// are the same whenever the page is made.
#pragma once

#include <optional>

#include <nlohmann/json.hpp>

namespace groundloop::apps {

/// What writing report.html took.
struct ReportCost {
  double seconds = 0.0;
  nlohmann::ordered_json before;  ///< without_report() of the metrics that the page was made from
};

/// `timing_s.total`, `scans_per_second` and `peak_memory_mb` without the report: of metrics that
/// were written before it those themselves.
[[nodiscard]] nlohmann::ordered_json without_report(const nlohmann::ordered_json& metrics);

/// Adds `timing_s.report` before the total, and `without_report`; nothing where nullopt.
void add_report_cost(nlohmann::ordered_json& metrics, const std::optional<ReportCost>& report);

/// The metrics as the page shows them: all figures without the report.
[[nodiscard]] nlohmann::ordered_json page_metrics(nlohmann::ordered_json metrics);

}  // namespace groundloop::apps
