// Merging with closures given, so that only the decisions and the poses are at stake: sessions
// drive along known ways, their odometry is exact unless a test says otherwise.
#include "backend/merging/session_merge.hpp"

#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "backend/graph/odometry_information.hpp"
#include "backend/merging/frame_check.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/pcd.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using groundloop::testing::TemporaryFolder;

constexpr int kMaps = 8;
constexpr int kScansOfAMap = 4;

Pose planar(double x, double y, double yaw) { return Pose(exp_so3({0.0, 0.0, yaw}), {x, y, 0.0}); }

// True pose of scan i of a bent way; `start` shifts it along the way.
Pose true_pose(int i, int start) {
  const double s = 10.0 * (i + start);
  return planar(s, 40.0 * std::sin(s / 120.0), std::atan(std::cos(s / 120.0) / 3.0));
}

class SessionMerge : public ::testing::Test {
 protected:
  // A session whose world is its first scan.
  StoredSession session(const std::string& name, int start, int maps = kMaps) {
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path / "local_maps");
    StoredSession result{SessionFolder(path), {}, {}, {}};
    SessionPart part;
    part.name = name;
    part.fingerprint = std::hash<std::string>()(name);
    const Pose T_own_world = true_pose(0, start).inverse();
    for (int i = 0; i < maps * kScansOfAMap; ++i)
      part.trajectory.push_back({100 * i, T_own_world * true_pose(i, start)});
    part.odometry = part.trajectory;
    const OdometryInformationOptions information;
    for (int m = 0; m < maps; ++m) {
      const auto first = static_cast<std::size_t>(m * kScansOfAMap);
      part.maps.push_back({m, first, first + kScansOfAMap - 1, 1, part.trajectory[first].pose});
      result.graph.vertices.push_back({m, part.trajectory[first].pose, m == 0});
      write_pcd(result.folder.local_map(m), {{0.0F, 0.0F, 0.0F}});
      if (m == 0) continue;
      const Pose step = part.maps[m - 1].T_world_map.inverse() * part.maps[m].T_world_map;
      result.graph.edges.push_back(
          {m - 1, m, step, odometry_information(step, information), EdgeKind::odometry});
    }
    result.parts.push_back(std::move(part));
    starts_[name] = start;
    return result;
  }

  // A verified closure between two sessions, `off` its error.
  ClosureRecord closure(const std::string& reference, int r, const std::string& query, int q,
                        const Pose& off = {}) const {
    ClosureRecord c;
    c.reference_session = reference;
    c.reference_map = r;
    c.query_session = query;
    c.query_map = q;
    c.matches = c.inliers = 10;
    c.status = ClosureStatus::accepted;
    c.overlap = 0.4;
    const Pose T_world_r = true_pose(r * kScansOfAMap, starts_.at(reference));
    const Pose T_world_q = true_pose(q * kScansOfAMap, starts_.at(query));
    c.T_query_reference = T_world_q.inverse() * T_world_r * off;
    c.initial_T_query_reference = c.T_query_reference;
    c.information.setIdentity();
    c.information *= 400.0;
    c.information.bottomRightCorner<3, 3>() *= 100.0;
    return c;
  }

  PairMatches matches(const StoredSession& a, const StoredSession& b,
                      std::vector<ClosureRecord> closures) const {
    return {a.parts[0].name, b.parts[0].name, a.parts[0].fingerprint, b.parts[0].fingerprint,
            std::move(closures)};
  }

  // Without registration: the maps are single points.
  static MergeOptions options() {
    MergeOptions o;
    o.connection.max_trials = 0;
    o.revisits.enabled = false;
    return o;
  }

  // Position error of the second session in the first one's frame, m.
  double error_between(const MergeResult& result, int a, int b) const {
    const MergedPart& reference = result.parts[a];
    const MergedPart& query = result.parts[b];
    double worst = 0.0;
    const Pose T_world_own = true_pose(0, starts_.at(reference.source->name));
    for (int i = 0; i < kMaps * kScansOfAMap; ++i) {
      const Pose expected = T_world_own.inverse() * true_pose(i, starts_.at(query.source->name));
      worst = std::max(worst, (query.trajectory[i].pose.translation - expected.translation).norm());
    }
    return worst;
  }

  TemporaryFolder folder_;
  std::map<std::string, int> starts_;
};

bool same(const Trajectory& a, const Trajectory& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].pose.translation != b[i].pose.translation ||
        a[i].pose.rotation.coeffs() != b[i].pose.rotation.coeffs())
      return false;
  }
  return a.size() == b.size();
}

TEST_F(SessionMerge, BringsASessionToTheReferencesFrame) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  const MergeResult result =
      merge_sessions(s, {matches(s[0], s[1], {closure("a", 3, "b", 0), closure("a", 5, "b", 2)})},
                     std::nullopt, options(), {});
  EXPECT_EQ(result.parts[1].frame, 0);
  EXPECT_LT(error_between(result, 0, 1), 1e-3);
  EXPECT_EQ(result.pairs[0].accepted, 2U);
}

TEST_F(SessionMerge, GivesUpAFalseClosureBesideTrueOnes) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  const MergeResult result = merge_sessions(
      s,
      {matches(s[0], s[1],
               {closure("a", 3, "b", 0), closure("a", 7, "b", 1, planar(30.0, 5.0, 1.0)),
                closure("a", 5, "b", 2)})},
      std::nullopt, options(), {});
  EXPECT_LT(error_between(result, 0, 1), 1e-3);
  EXPECT_EQ(result.closures[1].status, ClosureStatus::outlier);
  EXPECT_EQ(result.pairs[0].accepted, 2U);
}

TEST_F(SessionMerge, MakesNoConnectionOfClosuresThatContradictEachOther) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  std::mt19937 generator(7);
  std::vector<ClosureRecord> all;
  for (int i = 0; i < 6; ++i) {
    const auto offset = [&] { return static_cast<double>(generator() % 200) - 100.0; };
    all.push_back(closure("a", i, "b", 6 - i, planar(offset(), offset(), offset())));
  }
  const MergeResult result =
      merge_sessions(s, {matches(s[0], s[1], all)}, std::nullopt, options(), {});
  EXPECT_EQ(result.parts[1].frame, 1);
  EXPECT_TRUE(same(result.parts[0].trajectory, s[0].parts[0].trajectory));
  EXPECT_TRUE(same(result.parts[1].trajectory, s[1].parts[0].trajectory));
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("'b' not connected to 'a'"), std::string::npos);
}

TEST_F(SessionMerge, MakesNoConnectionWhereTwoAlignmentsAreClaimedAlike) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  // The false ones agree with each other: a shift of the whole session by 60 m.
  const auto shifted = [&](int r, int q) {
    ClosureRecord c = closure("a", r, "b", q);
    const Pose T_a_map = s[0].parts[0].maps[r].T_world_map;
    c.T_query_reference =
        c.T_query_reference * T_a_map.inverse() * planar(60.0, 0.0, 0.0) * T_a_map;
    return c;
  };
  const MergeResult result = merge_sessions(
      s,
      {matches(s[0], s[1],
               {closure("a", 3, "b", 0), closure("a", 4, "b", 1), closure("a", 5, "b", 2),
                shifted(3, 3), shifted(4, 4), shifted(5, 5)})},
      std::nullopt, options(), {});
  EXPECT_EQ(result.parts[1].frame, 1);
}

TEST_F(SessionMerge, LeavesTheOthersAsTheyAreWithoutTheUnconnectedOne) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12), session("c", 500)};
  const std::vector<PairMatches> ab{
      matches(s[0], s[1], {closure("a", 3, "b", 0), closure("a", 5, "b", 2)})};
  std::vector<PairMatches> all = ab;
  all.push_back(matches(s[0], s[2], {closure("a", 2, "c", 2, planar(3.0, 1.0, 0.3))}));
  all.push_back(matches(s[1], s[2], {}));
  const MergeResult with = merge_sessions(s, all, std::nullopt, options(), {});
  s.pop_back();
  const MergeResult without = merge_sessions(s, ab, std::nullopt, options(), {});
  EXPECT_EQ(with.parts[2].frame, 2);
  for (int p = 0; p < 2; ++p)
    EXPECT_TRUE(same(with.parts[p].trajectory, without.parts[p].trajectory));
}

TEST_F(SessionMerge, ConnectsThroughAThirdSession) {
  std::vector<StoredSession> s{session("a", 0), session("c", 20), session("b", 12)};
  const MergeResult result =
      merge_sessions(s,
                     {matches(s[0], s[1], {}),
                      matches(s[0], s[2], {closure("a", 3, "b", 0), closure("a", 5, "b", 2)}),
                      matches(s[1], s[2], {closure("c", 0, "b", 2), closure("c", 2, "b", 4)})},
                     std::nullopt, options(), {});
  EXPECT_EQ(result.parts[1].frame, 0);
  EXPECT_LT(error_between(result, 0, 1), 1e-3);
}

TEST_F(SessionMerge, HoldsTheFixedSession) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  // The closures disagree by 5 cm: one of the sessions has to give.
  const MergeResult result = merge_sessions(
      s,
      {matches(s[0], s[1],
               {closure("a", 3, "b", 0, planar(0.05, 0.0, 0.0)), closure("a", 7, "b", 4)})},
      std::size_t{1}, options(), {});
  EXPECT_EQ(result.parts[0].frame, 1);
  EXPECT_TRUE(same(result.parts[1].trajectory, s[1].parts[0].trajectory));
  EXPECT_FALSE(same(result.parts[0].trajectory, s[0].parts[0].trajectory));
  EXPECT_LT(error_between(result, 1, 0), 0.2);
}

TEST_F(SessionMerge, TakesMatchesInEitherDirection) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  const PairMatches turned =
      matches(s[1], s[0], {closure("b", 0, "a", 3), closure("b", 2, "a", 5)});
  const MergeResult result = merge_sessions(s, {turned}, std::nullopt, options(), {});
  EXPECT_LT(error_between(result, 0, 1), 1e-3);
  EXPECT_EQ(result.closures[0].reference_session, "a");
  EXPECT_EQ(result.closures[0].reference_map, 3);
}

TEST_F(SessionMerge, RefusesTwoRecordingsOfOneName) {
  std::vector<StoredSession> s{session("a", 0), session("a", 12)};
  EXPECT_THROW((void)merge_sessions(s, {}, std::nullopt, options(), {}), InputError);
}

TEST_F(SessionMerge, JoinsASessionWhoseOdometryErrsMoreThanItSays) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  // b turns by 2.5 degrees too much in each map, which states 0.18.
  SessionPart& b = s[1].parts[0];
  for (std::size_t i = 1; i < b.trajectory.size(); ++i) {
    const Pose step = b.odometry[i - 1].pose.inverse() * b.odometry[i].pose;
    b.trajectory[i].pose =
        b.trajectory[i - 1].pose * step * planar(0.0, 0.0, 2.5 / kScansOfAMap * M_PI / 180.0);
  }
  b.odometry = b.trajectory;
  for (int m = 0; m < kMaps; ++m) {
    b.maps[m].T_world_map = b.trajectory[b.maps[m].first_scan].pose;
    s[1].graph.vertices[m].pose = b.maps[m].T_world_map;
    if (m > 0)
      s[1].graph.edges[m - 1].T_from_to =
          b.maps[m - 1].T_world_map.inverse() * b.maps[m].T_world_map;
  }
  std::vector<ClosureRecord> closures;
  for (int q = 0; q < 5; ++q) closures.push_back(closure("a", q + 3, "b", q));
  MergeOptions as_stated = options();
  as_stated.connection.estimate_scale = false;
  const std::vector<PairMatches> given{matches(s[0], s[1], closures)};
  EXPECT_LT(merge_sessions(s, given, std::nullopt, as_stated, {}).pairs[0].accepted, 5U);
  const MergeResult result = merge_sessions(s, given, std::nullopt, options(), {});
  EXPECT_EQ(result.parts[1].frame, 0);
  EXPECT_EQ(result.pairs[0].accepted, 5U);
  EXPECT_GT(result.parts[0].odometry_scale * result.parts[1].odometry_scale, 2.0);
  EXPECT_NE(result.notes[0].find("times as much as it says"), std::string::npos);
  for (int q = 0; q < 5; ++q) {
    const Pose expected = true_pose(0, 0).inverse() * true_pose(q * kScansOfAMap, 12);
    EXPECT_LT((result.parts[1].maps[q].T_world_map.translation - expected.translation).norm(), 0.3);
  }
}

// Level ground with boxes that stand elsewhere in each: maps of places that are not the same.
Points ground_with_boxes(std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> anywhere(-60.0F, 60.0F), within(-1.0F, 1.0F);
  Points points;
  for (int i = 0; i < 4000; ++i) points.push_back({anywhere(generator), anywhere(generator), 0.0F});
  for (int box = 0; box < 25; ++box) {
    const float x = anywhere(generator), y = anywhere(generator);
    for (int i = 0; i < 80; ++i)
      points.push_back(
          {x + within(generator), y + within(generator), 2.0F + 2.0F * within(generator)});
  }
  return points;
}

TEST_F(SessionMerge, TwelveFalseClosuresThatAgreeAndNobodyConfirmsJoinNothing) {
  constexpr int kMany = 13;
  std::vector<StoredSession> s{session("a", 0, kMany), session("b", 0, kMany)};
  std::vector<ClosureRecord> all;
  for (int m = 0; m < kMany; ++m) {
    for (std::uint32_t i = 0; i < 2; ++i) {
      write_pcd(s[i].folder.local_map(m),
                ground_with_boxes(1U + 2U * static_cast<std::uint32_t>(m) + i));
    }
    if (m < kMany - 1) all.push_back(closure("a", m, "b", m));
  }
  MergeOptions with_trials = options();
  with_trials.connection.max_trials = MergeOptions().connection.max_trials;
  const MergeResult result =
      merge_sessions(s, {matches(s[0], s[1], all)}, std::nullopt, with_trials, {});
  EXPECT_EQ(result.parts[1].frame, 1);
  EXPECT_EQ(result.pairs[0].accepted, 0U);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("12 closures agree, but only 0 of 12 further pairs"),
            std::string::npos)
      << result.notes[0];
}

TEST_F(SessionMerge, OneClosureAloneIsNoEvidenceAndSaysWhatIsMissing) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  ClosureRecord strong = closure("a", 3, "b", 0);
  strong.inliers = 40;
  strong.overlap = 0.8;
  const MergeResult result =
      merge_sessions(s, {matches(s[0], s[1], {strong})}, std::nullopt, options(), {});
  EXPECT_EQ(result.parts[1].frame, 1);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("likelihood ratio"), std::string::npos) << result.notes[0];
}

TEST_F(SessionMerge, SessionsStillJoinedStayTogetherWhereTheFramesRootDropsOut) {
  const std::vector<StoredSession> s{session("a", 0), session("b", 12), session("c", 20)};
  const MergeOptions given = options();
  JointProblem problem(s, std::nullopt, given);
  const PoseGraph before = problem.graph;
  const std::vector<int> frames_before{0, 1, 2};
  // All were joined to a and lie in its frame; the solution leaves a's closure out.
  for (MergedPart& part : problem.parts) part.frame = 0;
  for (std::size_t v = 0; v < problem.graph.vertices.size(); ++v) {
    const int part = problem.part_of[v];
    const int start = starts_.at(s[static_cast<std::size_t>(part)].parts[0].name);
    problem.graph.vertices[v].pose =
        planar(3.0, 1.0, 0.2) * true_pose(0, start) * problem.graph.vertices[v].pose;
  }
  problem.closures = {closure("a", 3, "b", 0), closure("b", 2, "c", 0)};
  problem.closures[0].status = ClosureStatus::outlier;
  for (const ClosureRecord& c : problem.closures) {
    problem.graph.edges.push_back(problem.edge_of(c));
    problem.graph.edges.back().rejected = c.status == ClosureStatus::outlier;
  }
  check_frames(problem, frames_before, before);
  EXPECT_EQ(problem.parts[0].frame, 0);
  EXPECT_EQ(problem.parts[1].frame, 1);
  EXPECT_EQ(problem.parts[2].frame, 1);
  EXPECT_EQ(problem.graph.vertices[0].pose.translation, before.vertices[0].pose.translation);
  // In b's own world, c where it is from b.
  const Pose T_world_b = true_pose(0, 12);
  for (int m = 0; m < kMaps; ++m) {
    const Pose expected = T_world_b.inverse() * true_pose(m * kScansOfAMap, 20);
    const Pose& now = problem.graph.vertices[problem.vertex(2, m)].pose;
    EXPECT_LT((now.translation - expected.translation).norm(), 1e-9);
  }
  ASSERT_EQ(problem.notes.size(), 1U);
  EXPECT_NE(problem.notes[0].find("'b' with 'c' not connected to 'a'"), std::string::npos);
}

TEST_F(SessionMerge, MatchesFileReadsBackTheSame) {
  std::vector<StoredSession> s{session("a,\"1\"", 0), session("b", 12)};
  ClosureRecord c = closure("a,\"1\"", 3, "b", 0);
  c.information(1, 4) = c.information(4, 1) = 12.5;
  write_matches(folder_ / "m.csv", {matches(s[0], s[1], {c})});
  const std::vector<PairMatches> read = read_matches(folder_ / "m.csv");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].reference, "a,\"1\"");
  EXPECT_EQ(read[0].query_fingerprint, s[1].parts[0].fingerprint);
  ASSERT_EQ(read[0].closures.size(), 1U);
  EXPECT_EQ(read[0].closures[0].information, c.information);
  EXPECT_EQ(read[0].closures[0].T_query_reference.translation, c.T_query_reference.translation);
}

TEST_F(SessionMerge, MatchesFileThatWasCutOffIsRefused) {
  std::vector<StoredSession> s{session("a", 0), session("b", 12)};
  write_matches(folder_ / "m.csv", {matches(s[0], s[1], {closure("a", 3, "b", 0)})});
  std::filesystem::resize_file(folder_ / "m.csv",
                               std::filesystem::file_size(folder_ / "m.csv") - 40);
  EXPECT_THROW((void)read_matches(folder_ / "m.csv"), InputError);
}

}  // namespace
}  // namespace groundloop
