// What `inspect` says and draws of recordings whose contents are known.
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/inspection/proposed_run.hpp"
#include "apps/inspection/scan_rasters.hpp"
#include "apps/inspection/scan_timing.hpp"
#include "apps/inspection/terminal_sketch.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;
using testing::Bytes;
using testing::expect_input_error;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_command;
using testing::TemporaryFolder;
using testing::write_file;

class StampsOnly final : public Recording {
 public:
  explicit StampsOnly(std::vector<double> seconds) : seconds_(std::move(seconds)) {}
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return seconds_.size(); }
  Nanoseconds stamp(std::size_t i) const override { return std::llround(1e9 * seconds_[i]); }
  Scan read(std::size_t) override { return {}; }

 private:
  std::vector<double> seconds_;
  RecordingInfo info_;
};

TEST(ScanTiming, GapsAndJitterAreThoseOfTheStamps) {
  // Every 0.1 s; one scan missing after scan 2, three after scan 4; one 2 ms late.
  const ScanTiming timing =
      measure_timing(StampsOnly({0, 0.1, 0.2, 0.4, 0.5, 0.9, 1.002, 1.1, 1.2}));
  EXPECT_NEAR(timing.rate_hz, 10.0, 1e-6);
  EXPECT_NEAR(timing.duration_s, 1.2, 1e-9);
  ASSERT_EQ(timing.gaps.size(), 2U);
  EXPECT_EQ(timing.gaps[0].after, 2U);
  EXPECT_EQ(timing.gaps[0].missing, 1U);
  EXPECT_EQ(timing.gaps[1].after, 4U);
  EXPECT_EQ(timing.gaps[1].missing, 3U);
  EXPECT_NEAR(timing.gaps[1].seconds, 0.4, 1e-9);
  EXPECT_EQ(timing.missing, 4U);
  EXPECT_NEAR(timing.jitter_s, 0.002, 1e-6);
  EXPECT_EQ(measure_timing(StampsOnly({5})).rate_hz, 0.0);
}

TEST(ScanRasters, FromAboveForwardIsUpAndLeftIsLeft) {
  Scan scan;
  scan.points = {{9, 1, 0}, {1, 9, 3}, {1, 9, 2}, {-9, -9, 1}, {100, 0, 0}};
  const Raster raster = seen_from_above(scan, 4, 4, 10.0);
  std::size_t filled = 0;
  for (const float value : raster.values) filled += std::isnan(value) ? 0 : 1;
  EXPECT_EQ(filled, 3U);
  EXPECT_EQ(raster.at(1, 0), 0.0F);  // ahead, a little to the left
  EXPECT_EQ(raster.at(0, 1), 3.0F);  // to the left: the higher one
  EXPECT_EQ(raster.at(3, 3), 1.0F);  // behind, to the right
}

TEST(ScanRasters, RangeImageHoldsTheNearestRangeByAzimuthAndElevation) {
  Scan scan;
  scan.points = {{10, 0, 0}, {5, 0, 0}, {0, 4, 0}, {0, -3, 3}};
  View view;
  view.top_deg = 60;
  view.bottom_deg = -60;
  const Raster raster = range_image(scan, 36, 3, view);
  EXPECT_EQ(raster.at(18, 1), 5.0F);              // ahead: the middle
  EXPECT_EQ(raster.at(9, 1), 4.0F);               // left
  EXPECT_EQ(raster.at(27, 0), std::sqrt(18.0F));  // right and up by 45 degrees
  EXPECT_TRUE(std::isnan(raster.at(0, 1)));
}

TEST(ScanRasters, ASectorIsShownAsWideAsItIs) {
  Scan ahead, behind;
  for (int degrees = -30; degrees < 30; ++degrees) {
    const float a = static_cast<float>((degrees + 0.5) * M_PI / 180.0);
    ahead.points.emplace_back(std::cos(a), std::sin(a), 0.0F);
    behind.points.emplace_back(-std::cos(a), -std::sin(a), 0.0F);
  }
  EXPECT_NEAR(view_of(ahead).left_deg, 30.0, 1e-9);
  EXPECT_NEAR(view_of(ahead).right_deg, -30.0, 1e-9);
  EXPECT_NEAR(view_of(behind).left_deg - view_of(behind).right_deg, 60.0, 1e-9);
  for (const Scan& scan : {ahead, behind}) {
    const Raster raster = range_image(scan, 6, 1, view_of(scan));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_FALSE(std::isnan(raster.at(i, 0))) << i;
  }
}

TEST(TerminalSketch, DrawsInPlainCharactersOrUnicode) {
  Scan scan;
  scan.points = {{3.4F, 3.4F, 0}, {-3.4F, -3.4F, 0}};
  scan.times = {0.0F, 0.1F};
  const std::string ascii = sketch_scan(scan, {8, false});
  EXPECT_THAT(ascii, HasSubstr("from above, 5 m to each side, forward is up:\n"
                               " *      \n        \n        \n      * \n"));
  EXPECT_THAT(ascii, HasSubstr("+0.0000 to +0.1000 s from the stamp:\n07\n"));
  for (const char c : ascii) EXPECT_GE(c, 0);
  // Dots of 2 by 4 a character: the third of the left column, and the second of the right one.
  const std::string unicode = sketch_scan(scan, {8, true});
  EXPECT_THAT(unicode, HasSubstr("\u2800\u2804\u2800"));
  EXPECT_THAT(unicode, HasSubstr("\u2800\u2810\u2800\n"));
  EXPECT_THAT(unicode, Not(HasSubstr("\033")));
}

TEST(ProposedRun, WordsAreQuotedWhereAShellNeedsIt) {
  EXPECT_EQ(shell_word("/data/a-b_1.bag"), "/data/a-b_1.bag");
  EXPECT_EQ(shell_word("my drive"), "'my drive'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word("sim:town?seed=1&length=5"), "'sim:town?seed=1&length=5'");
}

class Inspect : public ::testing::Test {
 protected:
  // Five scans of a ring of points of one elevation.
  void write_scans() {
    for (int s = 0; s < 5; ++s) {
      Bytes file;
      for (int i = 0; i < 400; ++i) {
        const double a = i * M_PI / 200.0;
        file.floats(10 * std::cos(a), 10 * std::sin(a), 0.0, 0.5);
      }
      write_file(folder_ / ("d/s/" + std::to_string(s) + ".bin"), file);
    }
    write_file(folder_ / "d/s/times.txt", "0\n0.1\n0.2\n0.4\n0.5\n");
  }
  TemporaryFolder folder_;
};

TEST_F(Inspect, SaysWhatIsThereAsJson) {
  write_scans();
  const auto result = run_command({"inspect", (folder_ / "d/s").string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const auto json = nlohmann::json::parse(result.standard_output);
  EXPECT_EQ(json["scans"], 5);
  EXPECT_EQ(json["gaps"], 1);
  EXPECT_EQ(json["timing"]["gaps"][0]["after_scan"], 2);
  EXPECT_EQ(json["timing"]["missing_scans"], 1);
  EXPECT_EQ(json["sampled"]["points_max"], 400);
  EXPECT_NEAR(json["sampled"]["range_median_m"].get<double>(), 10.0, 1e-5);
  EXPECT_EQ(json["sampled"]["intensity_max"], 0.5);
  EXPECT_TRUE(json["warnings"].empty());
  EXPECT_EQ(json["proposed"]["command"],
            "groundloop run " + (folder_ / "d/s").string() + " --out session");
}

TEST_F(Inspect, ProposesGroundTruthThatLiesBeside) {
  write_scans();
  write_file(folder_ / "d/track_of_the_day.txt",
             "0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n0.2 2 0 0 0 0 0 1\n");
  write_file(folder_ / "d/readme.txt", "nothing of use\n");
  const auto result = run_command({"inspect", (folder_ / "d/s").string()});
  EXPECT_THAT(result.standard_output, HasSubstr("track_of_the_day.txt --out session\n"));
  EXPECT_THAT(result.standard_output, Not(HasSubstr("readme")));
  EXPECT_THAT(result.standard_output, Not(HasSubstr("from above")));  // no terminal
}

TEST_F(Inspect, DrawsIntoThePngThatIsAskedFor) {
  write_scans();
  const fs::path png = folder_ / "a.png";
  const auto result =
      run_command({"inspect", (folder_ / "d/s").string(), "--sketch", "--png", png.string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output, HasSubstr("from above, 10 m to each side"));
  std::ifstream in(png, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_GT(bytes.size(), 1000U);
  expect_input_error(
      run_command({"inspect", (folder_ / "d/s").string(), "--png", (png / "b.png").string()}),
      {"a.png"});
}

TEST_F(Inspect, WarningsAreSaid) {
  write_scans();
  fs::resize_file(folder_ / "d/s/4.bin", 30);
  const auto result = run_command({"inspect", (folder_ / "d/s").string()});
  EXPECT_THAT(result.standard_output, HasSubstr("warning        The last scan is left out"));
}

}  // namespace
}  // namespace groundloop::apps
