#include "apps/report/report.hpp"

#include <cmath>
#include <regex>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "apps/report/svg_plot.hpp"

namespace groundloop::apps {
namespace {

Trajectory circle(double radius, double sag) {
  Trajectory trajectory;
  for (int i = 0; i < 500; ++i) {
    const double a = 0.02 * i;
    StampedPose s;
    s.stamp = i * 100'000'000LL;
    s.pose.translation = {radius * std::cos(a), radius * std::sin(a), sag * a};
    trajectory.push_back(s);
  }
  return trajectory;
}

ReportInput filled() {
  ReportInput input;
  input.title = "run <of> a \"town\" & back";
  input.facts = {{"recording", "a & b"}, {"sensor", "64 beams"}};
  input.ground_truth = circle(50.0, 0.0);
  input.odometry = circle(50.5, 0.3);
  input.optimised = circle(50.1, 0.05);
  input.odometry_evaluation = evaluate_trajectory(input.odometry, input.ground_truth);
  input.optimised_evaluation = evaluate_trajectory(input.optimised, input.ground_truth);
  for (const char* status : {"accepted", "low_overlap"}) {
    ReportClosure closure;
    closure.reference = "1";
    closure.query = "9";
    closure.source = "detector";
    closure.status = status;
    closure.inliers = 12;
    closure.overlap = 0.61;
    closure.error_m = 0.25;
    closure.reference_position = {50, 0, 0};
    closure.query_position = {0, 50, 0};
    input.closures.push_back(closure);
  }
  input.precision_recall = {{3, 0.5, 0.9}, {6, 1.0, 0.7}};
  input.tables = {{"Map quality", "entropy", {"", "before"}, {{"mean", "0.1"}}}};
  input.timing_s = {{"odometry", 1.5}, {"total", 1.2}};
  input.images = {{"map 9", {{std::byte{'M'}, std::byte{'a'}, std::byte{'n'}, std::byte{'!'}}}}};
  input.configuration = "odometry:\n  voxel_size: 1\n";
  return input;
}

// Every element that is opened is closed, in order; an attribute never breaks out of its quotes.
void expect_well_formed(const std::string& html) {
  const std::set<std::string> empty{"meta", "img", "!doctype"};
  std::vector<std::string> open;
  const std::regex tag(R"(<(/?)([!a-zA-Z0-9]+)((?:[^<>"]|"[^"]*")*)>)");
  for (std::sregex_iterator it(html.begin(), html.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if (empty.contains(name) || (*it)[3].str().ends_with("/")) continue;
    if ((*it)[1].length() == 0) {
      open.push_back(name);
    } else {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), name) << it->position();
      open.pop_back();
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST(Report, IsOneWellFormedPageThatNeedsNothingElse) {
  const std::string html = make_report(filled());
  expect_well_formed(html);
  for (const char* outside : {"http:", "https:", "<script", "<link", "@import", "url("}) {
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  }
  EXPECT_NE(html.find("data:image/png;base64,TWFuIQ=="), std::string::npos);
}

TEST(Report, SaysWhatWasAskedOfIt) {
  const std::string html = make_report(filled());
  for (const char* text :
       {"run &lt;of&gt; a &quot;town&quot; &amp; back", "Height along the way", "APE", "se3",
        "low_overlap", "0.61", "Map quality", "voxel_size: 1", "nearest stamp", "Precision"}) {
    EXPECT_NE(html.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(Report, LeavesOutWhatThereIsNot) {
  ReportInput input;
  input.title = "bare";
  input.odometry = circle(50, 0);
  input.optimised = input.odometry;
  const std::string html = make_report(input);
  expect_well_formed(html);
  EXPECT_EQ(html.find("Error against"), std::string::npos);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(SvgPlot, DrawsToScaleAndInsideItsFrame) {
  const Plot plot{"t", "x", "y", true, false, {{"a", "after", {{0, 0}, {10, 0}, {10, 10}}, false}},
                  {}};
  const std::string svg = to_svg(plot);
  std::smatch match;
  ASSERT_TRUE(std::regex_search(
      svg, match,
      std::regex(R"(points="([\d.]+),([\d.]+) ([\d.]+),([\d.]+) ([\d.]+),([\d.]+) ")")));
  const double dx = std::stod(match[3]) - std::stod(match[1]);
  const double dy = std::stod(match[4]) - std::stod(match[6]);
  EXPECT_NEAR(dx, dy, 0.2) << "equal axes";
  EXPECT_GT(std::stod(match[1]), 64.0);
  EXPECT_LT(std::stod(match[3]), 884.0);
}

TEST(SvgPlot, SurvivesNothingAndSinglePoints) {
  const double nan = std::nan("");
  for (const Plot& plot :
       {Plot{"t", "x", "y", true, false, {}, {}},
        Plot{"t", "x", "y", false, true, {{"a", "after", {{1, 1}}, false}}, {}},
        Plot{"t", "x", "y", false, false, {{"a", "after", {{nan, 1}}, false}}, {}}}) {
    EXPECT_EQ(to_svg(plot).find("nan"), std::string::npos);
    EXPECT_EQ(to_svg(plot).find("inf"), std::string::npos);
  }
}

}  // namespace
}  // namespace groundloop::apps
