// Sessions of simulated recordings, merged by the command: the whole way from folders to a folder.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backend/session/session.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/trajectory.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using groundloop::testing::expect_input_error;
using groundloop::testing::run_command;
using groundloop::testing::TemporaryFolder;
using Json = nlohmann::json;
namespace fs = std::filesystem;

// Monday, another day on the same streets, and another town.
class Sessions {
 public:
  Sessions() {
    run("monday", "sim:town?sensor=spin16&length=500");
    run("tuesday", "sim:town?sensor=spin16&length=500&change=1");
    run("elsewhere", "sim:town?sensor=spin16&length=500&seed=9");
  }
  [[nodiscard]] std::string operator()(const std::string& name) const {
    return (folder_ / name).string();
  }
  [[nodiscard]] fs::path output(const std::string& name) const { return folder_ / name; }

 private:
  void run(const std::string& name, const std::string& recording) {
    const auto result = run_command(
        {"--quiet", "run", recording, "--out", (*this)(name), "--set", "map.write=false"});
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  }
  TemporaryFolder folder_;
};

// No two closures say the same of the same maps.
void expect_each_closure_once(const fs::path& session) {
  const std::vector<ClosureRecord> closures = read_closures(session / "closures.csv");
  for (std::size_t i = 0; i < closures.size(); ++i) {
    for (std::size_t j = i + 1; j < closures.size(); ++j) {
      const ClosureRecord &a = closures[i], &b = closures[j];
      if (a.status != ClosureStatus::accepted || b.status != ClosureStatus::accepted) continue;
      if (a.reference_session != b.reference_session || a.query_session != b.query_session ||
          a.reference_map != b.reference_map || a.query_map != b.query_map)
        continue;
      EXPECT_GT((a.T_query_reference.inverse() * b.T_query_reference).translation.norm(), 0.3)
          << a.reference_map << " " << a.query_map;
    }
  }
}

Json read_json(const fs::path& file) { return Json::parse(read_text(file)); }

void expect_that_it_aligns_another_day_and_leaves_another_town_alone(const Sessions& session) {
  const fs::path out = session.output("merged");
  const auto result = run_command({"merge", session("monday"), session("tuesday"),
                                   session("elsewhere"), "--out", out.string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_NE(result.standard_error.find("'elsewhere' is not connected"), std::string::npos)
      << result.standard_error;
  const Json metrics = read_json(out / "metrics.json");
  EXPECT_EQ(metrics["sessions"]["tuesday"]["frame"], "monday");
  EXPECT_EQ(metrics["sessions"]["elsewhere"]["frame"], "elsewhere");
  EXPECT_LT(metrics["ape"]["optimised"]["translation_m"]["rmse"], 1.0);
  EXPECT_EQ(metrics["closures_against_ground_truth"]["precision"], 1.0);
  EXPECT_EQ(read_text(out / "sessions" / "elsewhere" / "trajectory.tum"),
            read_text(session("elsewhere") + "/trajectory.tum"));
  expect_each_closure_once(out);
  // The tables of the whole are those of the recordings, numbered through.
  const auto whole = read_local_maps(out / "local_maps.csv");
  std::size_t maps = 0;
  for (const char* name : {"monday", "tuesday", "elsewhere"})
    maps += read_local_maps(out / "sessions" / name / "local_maps.csv").size();
  ASSERT_EQ(whole.size(), maps);
  for (std::size_t m = 0; m < maps; ++m)
    EXPECT_TRUE(fs::exists(SessionFolder(out).local_map(static_cast<int>(m))));
  EXPECT_EQ(whole.back().last_scan + 1, read_tum(out / "trajectory.tum").size());
}

void expect_that_it_merges_a_merged_session_again_and_holds_the_fixed_one(const Sessions& session) {
  const std::string first = (session.output("first")).string();
  ASSERT_EQ(
      run_command({"--quiet", "merge", session("monday"), session("elsewhere"), "--out", first})
          .exit_code,
      0);
  const auto result = run_command({"--quiet", "merge", first, session("tuesday"), "--out",
                                   (session.output("second")).string(), "--fix", first});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const Json manifest = read_json(session.output("second/manifest.json"));
  ASSERT_EQ(manifest["sessions"].size(), 3U);
  EXPECT_EQ(manifest["sessions"][2]["frame"], "monday");
  EXPECT_EQ(read_text(session.output("second/sessions/monday/trajectory.tum")),
            read_text(session("monday") + "/trajectory.tum"));
}

void expect_that_it_matches_from_a_file_give_the_same_merge(const Sessions& session) {
  const std::string matches = (session.output("m.csv")).string();
  ASSERT_EQ(
      run_command({"--quiet", "match", session("monday"), session("tuesday"), "--out", matches})
          .exit_code,
      0);
  ASSERT_EQ(run_command({"--quiet", "merge", session("monday"), session("tuesday"), "--out",
                         (session.output("with")).string(), "--matches", matches})
                .exit_code,
            0);
  ASSERT_EQ(run_command({"--quiet", "merge", session("monday"), session("tuesday"), "--out",
                         (session.output("without")).string()})
                .exit_code,
            0);
  EXPECT_EQ(read_json(session.output("with/metrics.json"))["pairs"][0]["matches_from_file"], true);
  for (const char* name : {"trajectory.tum", "closures.csv", "pose_graph.g2o", "map.pcd"})
    EXPECT_TRUE(read_file(session.output("with") / name) ==
                read_file(session.output("without") / name))
        << name;
}

void expect_that_it_leaves_a_damaged_session_out_and_says_why(const Sessions& session) {
  fs::copy(session("elsewhere"), session.output("damaged"), fs::copy_options::recursive);
  fs::resize_file(session.output("damaged/loop_database.bin"), 1000);
  const auto result = run_command({"merge", session("monday"), session("tuesday"),
                                   (session.output("damaged")).string(), "--out",
                                   (session.output("out")).string()});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.standard_error.find("'damaged' is left out"), std::string::npos);
  EXPECT_NE(result.standard_error.find("loop_database.bin"), std::string::npos);
  EXPECT_EQ(read_json(session.output("out/manifest.json"))["left_out"].size(), 1U);
  expect_input_error(run_command({"merge", session("monday"), (session.output("damaged")).string(),
                                  "--out", (session.output("none")).string()}),
                     {"1 usable session of 2", "loop_database.bin"});
  EXPECT_FALSE(fs::exists(session.output("none")));
}

void expect_that_it_names_a_session_that_is_not_there_or_unfinished(const Sessions& session) {
  fs::create_directories(session.output("empty"));
  expect_input_error(run_command({"merge", session("monday"), (session.output("empty")).string(),
                                  "--out", (session.output("out")).string()}),
                     {"manifest.json is missing"});
}

// One test: ctest gives each a process of its own, and the sessions are what takes the time.
TEST(MergeCommand, AlignsWhatBelongsTogetherAndNamesWhatDoesNot) {
  const Sessions session;
  expect_that_it_aligns_another_day_and_leaves_another_town_alone(session);
  expect_that_it_merges_a_merged_session_again_and_holds_the_fixed_one(session);
  expect_that_it_matches_from_a_file_give_the_same_merge(session);
  expect_that_it_leaves_a_damaged_session_out_and_says_why(session);
  expect_that_it_names_a_session_that_is_not_there_or_unfinished(session);
}

}  // namespace
}  // namespace groundloop
