#include "apps/report/report_cost.hpp"

namespace groundloop::apps {

using Json = nlohmann::ordered_json;

Json without_report(const Json& metrics) {
  if (metrics.contains("without_report")) return metrics["without_report"];
  Json figures = Json::object();
  if (metrics.contains("timing_s")) figures["total_s"] = metrics["timing_s"].value("total", 0.0);
  for (const char* name : {"scans_per_second", "peak_memory_mb"}) {
    if (metrics.contains(name)) figures[name] = metrics[name];
  }
  return figures;
}

void add_report_cost(Json& metrics, const std::optional<ReportCost>& report) {
  if (!report) return;
  Json& times = metrics["timing_s"];
  const Json total = times["total"];
  times.erase("total");
  times["report"] = report->seconds;
  times["total"] = total;
  metrics["without_report"] = report->before;
}

Json page_metrics(Json metrics) {
  if (!metrics.contains("without_report")) return metrics;
  const Json figures = metrics["without_report"];
  metrics.erase("without_report");
  metrics["timing_s"].erase("report");
  if (figures.contains("total_s")) metrics["timing_s"]["total"] = figures["total_s"];
  for (const char* name : {"scans_per_second", "peak_memory_mb"}) {
    if (figures.contains(name)) metrics[name] = figures[name];
  }
  return metrics;
}

}  // namespace groundloop::apps
