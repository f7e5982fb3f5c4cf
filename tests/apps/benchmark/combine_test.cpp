#include <cmath>

#include <gtest/gtest.h>

#include "apps/benchmark/measures.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

Result with_figure(const std::string& subject, const std::string& name, double value) {
  Result r;
  r.kind = "recording";
  r.subject = subject;
  r.figures[name] = value;
  return r;
}

Result with_closures(const std::string& subject, std::size_t references,
                     std::vector<JudgedClosure> closures) {
  Result r;
  r.kind = "recording";
  r.subject = subject;
  r.detections = Detections{references, 0, 10, true, std::move(closures)};
  return r;
}

std::vector<const Result*> pointers(const std::vector<Result>& results) {
  std::vector<const Result*> list;
  for (const Result& r : results) list.push_back(&r);
  return list;
}

TEST(Combine, StandardErrorOfAMeanIsThatOfTheTextbook) {
  const std::vector<Result> results{with_figure("a", "ape", 1.0), with_figure("b", "ape", 2.0),
                                    with_figure("c", "ape", 6.0), with_figure("d", "drift", 9.0)};
  const Combined c = combine(*find_measure("ape"), pointers(results));
  EXPECT_EQ(c.results, 3U);
  EXPECT_DOUBLE_EQ(c.value.value(), 3.0);
  // s = sqrt(((-2)^2 + (-1)^2 + 3^2) / 2), over sqrt(3)
  EXPECT_NEAR(c.error.value(), std::sqrt(7.0) / std::sqrt(3.0), 1e-12);
}

TEST(Combine, SumsAndSingleRecordingsHaveNoError) {
  const std::vector<Result> results{with_figure("a", "scans", 5), with_figure("b", "scans", 7)};
  const Combined sum = combine(*find_measure("scans"), pointers(results));
  EXPECT_DOUBLE_EQ(sum.value.value(), 12.0);
  EXPECT_FALSE(sum.error);
  EXPECT_FALSE(combine(*find_measure("ape"), pointers({with_figure("a", "ape", 1.0)})).error);
  EXPECT_FALSE(combine(*find_measure("ape"), {}).value);
}

TEST(Combine, PoolsTheCurvesOfRecordings) {
  // One list: 9 true, 8 false, 7 true; four references in all.
  const std::vector<Result> results{
      with_closures("a", 3, {{9, true, false, true}, {7, true, false, false}}),
      with_closures("b", 1, {{8, false, false, false}})};
  const Combined ap = combine(*find_measure("ap"), pointers(results));
  EXPECT_NEAR(ap.value.value(), 0.25 * 1.0 + 0.25 * 2.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(combine(*find_measure("r1"), pointers(results)).value.value(), 0.25);
  EXPECT_DOUBLE_EQ(combine(*find_measure("chance"), pointers(results)).value.value(), 0.2);
  EXPECT_DOUBLE_EQ(combine(*find_measure("ap_pose"), pointers(results)).value.value(), 0.25);
  // Left out: a gives 0, b gives 2/3. Their spread about the mean of 1/3, times (n - 1) / n.
  EXPECT_NEAR(ap.error.value(), std::sqrt(0.5 * 2.0 / 9.0), 1e-12);
}

TEST(Combine, ADetectorWithoutPosesHasNoFigureOfThem) {
  Result r = with_closures("a", 1, {{9, true, false, false}});
  EXPECT_DOUBLE_EQ(combine(*find_measure("ap_pose"), pointers({r})).value.value(), 0.0);
  r.detections->poses = false;
  EXPECT_FALSE(combine(*find_measure("ap_pose"), pointers({r})).value);
  EXPECT_DOUBLE_EQ(combine(*find_measure("ap"), pointers({r})).value.value(), 1.0);
}

TEST(Combine, UncertainPairsCountOnNeitherSide) {
  Result r = with_closures("a", 2, {{9, false, true, false}, {8, true, false, true}});
  r.detections->uncertain = 1;
  EXPECT_DOUBLE_EQ(combine(*find_measure("ap"), pointers({r})).value.value(), 0.25);
  EXPECT_DOUBLE_EQ(combine(*find_measure("ap_certain"), pointers({r})).value.value(), 1.0);
}

TEST(CombineDifference, ComparesTheRecordingsThatBothHave) {
  const std::vector<Result> before{with_figure("a", "ape", 1.0), with_figure("b", "ape", 2.0),
                                   with_figure("x", "ape", 50.0)};
  const std::vector<Result> after{with_figure("b", "ape", 1.5), with_figure("a", "ape", 0.5)};
  const Combined d = combine_difference(*find_measure("ape"), pointers(before), pointers(after));
  EXPECT_EQ(d.results, 2U);
  EXPECT_DOUBLE_EQ(d.value.value(), -0.5);
  // Both fell by as much: no doubt, though they differ from each other.
  EXPECT_NEAR(d.error.value(), 0.0, 1e-12);
}

TEST(Measures, HaveNamesOfTheirOwnAndEveryTableHasItsColumns) {
  for (const Measure& m : measures()) EXPECT_EQ(find_measure(m.name), &m) << m.name;
  for (const TableKind& kind : table_kinds()) {
    for (const std::string& column : kind.columns)
      EXPECT_NE(find_measure(column), nullptr) << column;
  }
}

TEST(Results, ReadBackAsTheyWereWritten) {
  const groundloop::testing::TemporaryFolder folder;
  Results results;
  results.title = "t";
  results.made = {{"groundloop", "1"}, {"machine", "m"}};
  results.results = {with_closures("a", 3, {{0.1, true, false, true}})};
  results.results[0].figures["ape"] = 0.1 + 0.2;
  results.gaps = {{"recording b", "missing: b"}};
  write_results(folder / "results.json", results);
  const Results again = read_results(folder / "results.json");
  EXPECT_EQ(again.title, "t");
  EXPECT_EQ(again.made, results.made);
  ASSERT_EQ(again.results.size(), 1U);
  EXPECT_EQ(again.results[0].figures, results.results[0].figures);
  EXPECT_EQ(again.results[0].detections->closures[0].score, 0.1);
  EXPECT_TRUE(again.results[0].detections->closures[0].right_pose);
  EXPECT_EQ(again.gaps[0].why, "missing: b");
  write_text_atomically(folder / "results.json", "{\"benchmark_format\": 0}");
  EXPECT_THROW((void)read_results(folder / "results.json"), InputError);
}

}  // namespace
}  // namespace groundloop::apps
