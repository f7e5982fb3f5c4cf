#include "apps/report/report_cost.hpp"

#include <gtest/gtest.h>

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

Json metrics(double total, double memory) {
  return {{"scans", 100},
          {"timing_s", {{"odometry", 2.0}, {"total", total}}},
          {"scans_per_second", 100.0 / total},
          {"peak_memory_mb", memory}};
}

TEST(ReportCost, CountsInTheFiguresAndNotOnThePage) {
  const Json before = metrics(4.0, 200.0);
  Json after = metrics(9.0, 300.0);
  add_report_cost(after, ReportCost{5.0, without_report(before)});
  EXPECT_EQ(after["timing_s"]["total"], 9.0);
  EXPECT_EQ(after["timing_s"]["report"], 5.0);
  EXPECT_EQ(after["peak_memory_mb"], 300.0);
  EXPECT_EQ(after["without_report"]["total_s"], 4.0);
  // The page is made before the cost is known and made again after it: the same figures, bytes too.
  EXPECT_EQ(page_metrics(after).dump(), page_metrics(before).dump());
  EXPECT_EQ(page_metrics(before).dump(), before.dump());
}

TEST(ReportCost, NothingIsAddedBeforeThereIsAny) {
  Json document = metrics(4.0, 200.0);
  add_report_cost(document, std::nullopt);
  EXPECT_EQ(document.dump(), metrics(4.0, 200.0).dump());
}

}  // namespace
}  // namespace groundloop::apps
