#include "apps/commands/closure_list.hpp"

#include <gtest/gtest.h>

#include "apps/commands/reference_file.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

using groundloop::testing::TemporaryFolder;

// A session of four maps of ten scans, a metre apart along x.
EvaluatedPart part(const std::string& name) {
  EvaluatedPart p;
  p.name = name;
  p.recording = "somewhere";
  for (int i = 0; i < 40; ++i) {
    p.odometry.push_back({1'000'000 * i, Pose(Eigen::Quaterniond::Identity(), {1.0 * i, 0, 0})});
  }
  for (int m = 0; m < 4; ++m) {
    const auto first = static_cast<std::size_t>(10 * m);
    p.maps.push_back({m, first, first + 9, 0, p.odometry[first].pose});
  }
  return p;
}

std::vector<ReportedClosure> read(const std::string& text,
                                  const std::vector<EvaluatedPart>& parts = {part("a")}) {
  const TemporaryFolder folder;
  write_text_atomically(folder / "list.csv", text);
  return read_closure_list(folder / "list.csv", parts);
}

TEST(ClosureList, ReadsPairsOfMapsWithScoreAndWithoutPose) {
  const auto list = read("# of a detector\nquery_map,reference_map,score,remark\n3,0,0.25,x\n");
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].reference, (MapKey{0, 0}));
  EXPECT_EQ(list[0].query, (MapKey{0, 3}));
  EXPECT_DOUBLE_EQ(list[0].score, 0.25);
  EXPECT_FALSE(list[0].initial_T_query_reference);
  EXPECT_TRUE(list[0].detector);
}

TEST(ClosureList, TheOlderMapIsTheReferenceAndThePoseTurnsRound) {
  const auto list = read(
      "reference_map,query_map,tx,ty,tz,qx,qy,qz,qw\n3,1,5,0,0,0,0,0.7071067811865476,"
      "0.7071067811865476\n");
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].reference.map, 1);
  EXPECT_EQ(list[0].query.map, 3);
  // p -> R p + 5 x, turned round: p -> R' (p - 5 x); R turns x to y, R' turns x to -y.
  EXPECT_NEAR(list[0].initial_T_query_reference->translation.y(), 5.0, 1e-9);
  EXPECT_DOUBLE_EQ(list[0].score, 1.0);
}

TEST(ClosureList, PairsOfScansBecomePairsOfMapsAndTheBestOfThemStays) {
  // Scan 32 stands where scan 5 stood: their maps' origins lie 3 m apart.
  const auto list = read(
      "reference_scan,query_scan,score,tx,ty,tz,qx,qy,qz,qw\n"
      "7,35,0.5,9,9,9,0,0,0,1\n"
      "5,32,0.9,0,0,0,0,0,0,1\n");
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].reference.map, 0);
  EXPECT_EQ(list[0].query.map, 3);
  EXPECT_DOUBLE_EQ(list[0].score, 0.9);
  EXPECT_NEAR(list[0].initial_T_query_reference->translation.x(), 2.0 - 5.0, 1e-9);
}

TEST(ClosureList, OfTwoSessionsTheFirstIsTheReference) {
  const std::vector<EvaluatedPart> both{part("a"), part("b")};
  const auto list = read("reference_map,query_map,score\n3,0,1\n", both);
  EXPECT_EQ(list[0].reference, (MapKey{0, 3}));
  EXPECT_EQ(list[0].query, (MapKey{1, 0}));
  const auto named =
      read("reference_session,reference_map,query_session,query_map,inliers\nb,2,a,1,7\n", both);
  EXPECT_EQ(named[0].reference, (MapKey{0, 1}));
  EXPECT_EQ(named[0].query, (MapKey{1, 2}));
  EXPECT_DOUBLE_EQ(named[0].score, 7.0);
}

TEST(ClosureList, NamesFileLineAndWhatIsMissing) {
  const auto expect_error = [](const std::string& text, const std::string& part) {
    try {
      (void)read(text);
      ADD_FAILURE() << text;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  expect_error("0,3,0.5\n", "must name the columns");
  expect_error("reference_map,query_map\n0,9\n", "list.csv:2");
  expect_error("reference_scan,query_scan\n0,40\n", "no scan 40");
  expect_error("reference_map,query_map,score\n0,3\n", "2 fields, expected 3");
  expect_error("reference_map,query_map,score\n0,3,high\n", "'high'");
  expect_error("", "empty");
}

TEST(ReferenceFile, ReadsBackWhatWasWrittenOfTheSameMapsOnly) {
  const TemporaryFolder folder;
  const std::vector<EvaluatedPart> parts{part("a")};
  const std::vector<PairOverlap> pairs{{{0, 0}, {0, 3}, 0.24, TravelDirection::opposite, 1.25}};
  write_references(folder / "r.csv", parts, pairs, {}, 7);
  EXPECT_FALSE(read_references(folder / "r.csv", parts, 8));
  EXPECT_FALSE(read_references(folder / "none.csv", parts, 7));
  const auto again = read_references(folder / "r.csv", parts, 7);
  ASSERT_TRUE(again && again->size() == 1);
  EXPECT_EQ(again->front().query.map, 3);
  EXPECT_DOUBLE_EQ(again->front().overlap, 0.24);
  EXPECT_EQ(again->front().direction, TravelDirection::opposite);
  EXPECT_DOUBLE_EQ(again->front().distance, 1.25);
  const std::string text = read_text(folder / "r.csv");
  EXPECT_NE(text.find("a,0,a,3,0.24,0,1,opposite,1.25"), std::string::npos) << text;
}

}  // namespace
}  // namespace groundloop::apps
