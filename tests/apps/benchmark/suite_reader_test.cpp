#include <gtest/gtest.h>

#include "apps/benchmark/suite.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

using groundloop::testing::TemporaryFolder;

Suite read(const TemporaryFolder& folder, const std::string& text) {
  write_text_atomically(folder / "suite.yaml", text);
  return read_suite((folder / "suite.yaml").string());
}

void expect_error(const std::string& text, const std::vector<std::string>& parts) {
  const TemporaryFolder folder;
  try {
    (void)read(folder, text);
    FAIL() << "no error for\n" << text;
  } catch (const InputError& e) {
    for (const std::string& part : parts) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  }
}

constexpr const char* kTown = "recordings:\n  - {name: a, path: here}\n";

TEST(SuiteReader, WritesOutEveryCombinationOfWords) {
  const TemporaryFolder folder;
  const Suite suite = read(folder, R"(
recordings:
  - name: town_{sensor}_{seed}
    group: town {sensor}
    path: sim:town?sensor={sensor}&seed={seed}
    for: {sensor: [spin16, raster], seed: [1, 2, 3]}
pairs:
  - reference: town_spin16_{seed}
    query: town_raster_{seed}
    group: across
    for: {seed: [1, 2]}
)");
  ASSERT_EQ(suite.recordings.size(), 6U);
  EXPECT_EQ(suite.recordings[1].name, "town_spin16_2");
  EXPECT_EQ(suite.recordings[4].path, "sim:town?sensor=raster&seed=2");
  EXPECT_EQ(suite.recordings[4].group, "town raster");
  ASSERT_EQ(suite.pairs.size(), 2U);
  EXPECT_EQ(suite.pairs[1].name, "town_spin16_2+town_raster_2");
  ASSERT_EQ(suite.configurations.size(), 1U);
  EXPECT_EQ(suite.configurations[0].name, "default");
  EXPECT_FALSE(suite.tables.empty());
}

TEST(SuiteReader, RepeatsConfigurationsUnderOneName) {
  const TemporaryFolder folder;
  const Suite suite = read(folder, std::string(kTown) + R"(
configurations:
  - name: paper
    preset: paper
    set: {consensus.seed: "{seed}", features: {pruning: off}}
    for: {seed: [1, 2]}
)");
  ASSERT_EQ(suite.configurations.size(), 2U);
  EXPECT_EQ(suite.configurations[1].name, "paper");
  EXPECT_EQ(suite.configurations[1].repetition, "seed=2");
  EXPECT_EQ(suite.configurations[1].settings,
            (std::vector<std::string>{"consensus.seed=2", "features.pruning=off"}));
}

TEST(SuiteReader, TakesOverRecordingsAndPairsOfASuiteBesideIt) {
  const TemporaryFolder folder;
  write_text_atomically(folder / "other.yaml", std::string(kTown) +
                                                   "  - {name: b, path: there}\n"
                                                   "pairs:\n  - {reference: a, query: b}\n"
                                                   "configurations:\n  - {name: not this}\n");
  const Suite suite = read(folder, "include: other.yaml\nrecordings:\n  - {name: c, path: far}\n");
  ASSERT_EQ(suite.recordings.size(), 3U);
  EXPECT_EQ(suite.recordings[2].name, "c");
  EXPECT_EQ(suite.pairs.size(), 1U);
  EXPECT_EQ(suite.configurations[0].name, "default");
}

TEST(SuiteReader, NamesLineAndNearestKeyOfAMistake) {
  expect_error("recordings:\n  - name: a\n    path: p\n    grupp: x\n",
               {"suite.yaml:4", "grupp", "did you mean 'group'"});
  expect_error(std::string(kTown) + "tables:\n  - {kind: closures, columns: [a_p]}\n",
               {"a_p", "did you mean 'ap'"});
  expect_error(std::string(kTown) + "tables:\n  - {kind: closure}\n", {"closure", "closures"});
  expect_error(std::string(kTown) + "pairs:\n  - {reference: a, query: b}\n",
               {"no recording is called 'b'"});
  expect_error("recordings:\n  - {name: a}\n", {"'path' is missing"});
  expect_error("recordings:\n  - {name: a/b, path: p}\n", {"a/b"});
  expect_error("recordings:\n  - {name: a, path: p, references: [gps]}\n", {"gps", "truth"});
  expect_error(std::string(kTown) + "  - {name: a, path: q}\n", {"two recordings", "'a'"});
  expect_error("recordings: [\n", {"no valid YAML"});
  expect_error("title: nothing\n", {"names no recordings"});
  expect_error("include: nowhere.yaml\n", {"nowhere.yaml", "quick"});
}

TEST(SuiteReader, ReadsEverySuiteThatIsBuiltIn) {
  for (const std::string& name : suite_names()) {
    EXPECT_FALSE(read_suite(name).title.empty()) << name;
  }
}

}  // namespace
}  // namespace groundloop::apps
