#include "apps/cli/closing_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/commands/progress_bar.hpp"

namespace groundloop::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

Json metrics() {
  return Json::parse(R"({
    "scans": 1905, "predicted_scans": 0, "local_maps": 31, "path_length_m": 3719.4,
    "closures": {"candidates": 105, "accepted": 17},
    "timing_s": {"read": 1.5, "odometry": 20.25, "map": 0.5, "report": 5.0, "total": 31.0},
    "scans_per_second": 61.45, "peak_memory_mb": 204.2,
    "map_quality": {"pairs": 9, "before": {"plane_thickness_m": 0.151},
                    "after": {"plane_thickness_m": 0.084}, "worse": false, "given_up": false},
    "ape": {"odometry": {"translation_m": {"rmse": 5.74}},
            "optimised": {"translation_m": {"rmse": 0.951}}}})");
}

std::string table(const Json& figures) {
  return closing_table(figures, "out/session/", 200, false);
}

TEST(ClosingTable, SaysWhatWasFoundHowGoodItIsAndWhatItTook) {
  const std::string text = table(metrics());
  EXPECT_THAT(text, HasSubstr("scans       1 905 scans, 3 719 m, 31 local maps\n"));
  EXPECT_THAT(text, HasSubstr("closures    17 accepted of 105 candidates\n"));
  EXPECT_THAT(text, HasSubstr("APE 5.74 m by odometry, 0.95 m optimised"));
  EXPECT_THAT(text, HasSubstr("0.151 m thick by odometry, 0.084 m optimised"));
  EXPECT_THAT(text, HasSubstr("31.0 s, 61.5 scans a second (busy: odometry 20.2 s, report 5.0 s, "
                              "read 1.5 s, map 0.5 s)\n"));
  EXPECT_THAT(text, HasSubstr("memory      204 MB at most\n"));
}

TEST(ClosingTable, NamesPlacesAsTheCommandLineDid) {
  const std::string text = table(metrics());
  EXPECT_THAT(text, HasSubstr("out/session/report.html"));
  EXPECT_THAT(text, HasSubstr("groundloop export out/session --out map.las"));
  EXPECT_THAT(text, Not(HasSubstr("doctor")));
}

TEST(ClosingTable, SendsToTheDoctorWhereNoLoopWasClosed) {
  Json figures = metrics();
  figures["closures"]["accepted"] = 0;
  EXPECT_THAT(table(figures), HasSubstr("groundloop doctor out/session"));
}

TEST(ClosingTable, IsSilentAboutWhatIsNotKnown) {
  Json figures = metrics();
  figures.erase("ape");
  figures.erase("map_quality");
  EXPECT_THAT(table(figures), Not(HasSubstr("error")));
  EXPECT_THAT(table(figures), Not(HasSubstr("planes")));
}

TEST(ProgressLine, HasRateAndTimeLeft) {
  EXPECT_EQ(progress_line("odometry", 50, 200, 10.0, 100),
            "odometry [=======                       ] 50/200  10.0/s  0:15 left");
}

TEST(ProgressLine, KeepsToTheTerminal) {
  EXPECT_EQ(progress_line("odometry", 50, 200, 10.0, 40), "odometry 50/200  10.0/s  0:15 left");
  EXPECT_LE(progress_line("overlaps between sessions", 50, 200, 10.0, 20).size(), 20U);
}

TEST(ProgressLine, DoesNotGuessWhereTheEndIsNotKnown) {
  EXPECT_EQ(progress_line("revisits", 7, 0, 2.0, 100), "revisits 7  2.0/s");
  EXPECT_EQ(progress_line("report", 0, 0, 0.0, 100), "report ...");
}

}  // namespace
}  // namespace groundloop::apps
