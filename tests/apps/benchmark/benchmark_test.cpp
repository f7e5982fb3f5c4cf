#include "apps/benchmark/benchmark.hpp"

#include <gtest/gtest.h>

#include "apps/benchmark/results.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

constexpr const char* kSuite = R"(
title: Tiny
recordings:
  - name: town_{seed}
    group: towns
    path: sim:town?sensor=spin16&length=12&seed={seed}
    for: {seed: [1, 2]}
  - {name: absent, path: nowhere, needs: [nowhere/truth.txt]}
pairs:
  - {reference: town_1, query: town_2, overlap: false}
  - {reference: town_1, query: absent}
configurations:
  - {name: default}
detectors:
  - {name: no pruning, set: {features.pruning: off}}
  - name: somebody's
    command: [sh, -c, 'echo reference_map,query_map,score > "$0"', "{out}"]
)";

TEST(Benchmark, RunsASuiteAndLeavesTablesAndWhatWasMissing) {
  const groundloop::testing::TemporaryFolder folder;
  write_text_atomically(folder / "tiny.yaml", kSuite);
  BenchmarkRequest request;
  request.suite = (folder / "tiny.yaml").string();
  request.data = folder / "data";
  request.runner.groundloop = GROUNDLOOP_BINARY;
  request.runner.out = folder / "out";
  const BenchmarkSummary summary = run_benchmark(request, {});
  for (const StepOutcome& f : summary.failures) ADD_FAILURE() << f.name << ": " << f.why;
  EXPECT_EQ(summary.steps, summary.done);
  ASSERT_EQ(summary.missing.size(), 2U);
  EXPECT_EQ(summary.missing[0].what, "recording absent");
  EXPECT_EQ(summary.missing[0].why, "missing: " + (folder / "data" / "nowhere").string());
  const Results results = read_results(folder / "out" / "results.json");
  // Two recordings by three detectors, one pair by two.
  EXPECT_EQ(results.results.size(), 8U);
  const std::string report = read_text(folder / "out" / "report.md");
  for (const char* text :
       {"# Tiny", "## Odometry", "towns", "no pruning", "somebody's", "recording absent"}) {
    EXPECT_NE(report.find(text), std::string::npos) << text;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "tables" / "01_odometry.tex"));
  EXPECT_NE(compare_folders(folder / "out", folder / "out").find("difference"), std::string::npos);
}

TEST(Benchmark, RefusesAFolderOfOtherThings) {
  const groundloop::testing::TemporaryFolder folder;
  write_text_atomically(folder / "mine" / "thesis.txt", "years of work");
  groundloop::testing::expect_input_error(
      groundloop::testing::run_command({"benchmark", "quick", "--out", (folder / "mine").string()}),
      {"mine", "no results of a benchmark"});
}

TEST(Benchmark, ListsStepsWithoutRunningAny) {
  const groundloop::testing::TemporaryFolder folder;
  const auto listed = groundloop::testing::run_command(
      {"benchmark", "quick", "--out", (folder / "out").string(), "--list"});
  EXPECT_EQ(listed.exit_code, 0);
  EXPECT_NE(listed.standard_output.find("open  run~default~"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace groundloop::apps
