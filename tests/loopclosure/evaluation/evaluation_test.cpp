#include "loopclosure/evaluation/evaluation.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "loopclosure/evaluation/reference_alignment.hpp"

namespace groundloop {
namespace {

TEST(ReferenceOverlap, EqualsVoxelsCountedByHand) {
  // Query voxels along x: 0 1 2 3 (0 twice). Reference: 0 1, moved by three voxels: 3 4.
  const Points query{{0.1F, 0, 0}, {0.2F, 0, 0}, {0.6F, 0, 0}, {1.1F, 0, 0}, {1.6F, 0, 0}};
  const Points reference{{0.1F, 0.1F, 0.1F}, {0.6F, 0.1F, 0.1F}};
  const Pose shift(Eigen::Quaterniond::Identity(), {1.5, 0, 0});
  EXPECT_DOUBLE_EQ(reference_overlap(reference, query, Pose()), 1.0);
  EXPECT_DOUBLE_EQ(reference_overlap(reference, query, shift), 0.5);
  EXPECT_DOUBLE_EQ(reference_overlap(reference, query, shift * shift), 0.0);
  EXPECT_DOUBLE_EQ(reference_overlap({}, query, Pose()), 0.0);
}

// Walls and ground of a yard of 60 m whose corners differ.
Points yard(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  Points points;
  for (int i = 0; i < 20000; ++i) points.emplace_back(60 * unit(rng), 60 * unit(rng), 0.0F);
  for (int i = 0; i < 5000; ++i) points.emplace_back(60 * unit(rng), 0.0F, 8 * unit(rng));
  for (int i = 0; i < 5000; ++i) points.emplace_back(0.0F, 40 * unit(rng), 6 * unit(rng));
  for (int i = 0; i < 3000; ++i) points.emplace_back(30 + 10 * unit(rng), 20.0F, 4 * unit(rng));
  return points;
}

Points moved(const Points& points, const Pose& T) {
  const PoseF transform(T);
  Points result;
  for (const Eigen::Vector3f& p : points) result.push_back(transform * p);
  return result;
}

TEST(ReferenceAlignment, RecoversAKnownMotionFromAMetreAway) {
  // Other samples of the same surfaces, so that no two points are the same.
  const Pose T_query_reference = exp_se3((Vector6d() << 5, -3, 0.4, 0.02, -0.03, 1.2).finished());
  const Points query = moved(yard(1), T_query_reference);
  const Pose start =
      T_query_reference * exp_se3((Vector6d() << 0.5, -0.6, 0.3, 0.005, 0.005, 0.01).finished());
  const ReferenceAlignment aligned = reference_alignment(ReferenceTarget(query), yard(2), start);
  EXPECT_TRUE(aligned.converged);
  const Vector6d error = log_se3(T_query_reference.inverse() * aligned.T_query_reference);
  EXPECT_LT(error.head<3>().norm(), 0.05);
  EXPECT_LT(error.tail<3>().norm(), 0.002);
}

TEST(ReferenceAlignment, WithoutCommonGroundLeavesTheInitialPose) {
  const Pose far(Eigen::Quaterniond::Identity(), {500, 0, 0});
  const ReferenceAlignment aligned = reference_alignment(ReferenceTarget(yard(1)), yard(2), far);
  EXPECT_FALSE(aligned.converged);
  EXPECT_EQ(aligned.T_query_reference.translation, far.translation);
}

TEST(ReferenceTarget, FindsTheNearestPointOrNone) {
  const Points points = yard(3);
  const ReferenceTarget target(points);
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<float> uniform(-5.0F, 65.0F);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f p(uniform(rng), uniform(rng), 0.1F * uniform(rng));
    float best = 1.5F * 1.5F;
    for (const Eigen::Vector3f& q : points) best = std::min(best, (p - q).squaredNorm());
    for (const std::optional<std::size_t> guess :
         {std::optional<std::size_t>(), {points.size() / 2}}) {
      const std::optional<std::size_t> found = target.nearest(p, 1.5F, guess);
      ASSERT_EQ(found.has_value(), best < 1.5F * 1.5F);
      if (found) {
        EXPECT_FLOAT_EQ((p - target.points()[*found]).squaredNorm(), best);
      }
    }
  }
}

// Six maps: 0 and 4 see one yard, 1 and 5 another, the query going the other way; 2 and 3 see
// nothing in common.
struct Drive {
  std::vector<EvaluatedMap> maps;
  std::vector<ReportedClosure> closures;
  Drive() {
    for (int map = 0; map < 6; ++map) {
      const int place = map % 4;
      EvaluatedMap m;
      m.key = {0, map};
      const bool back = map == 5;
      const Pose T_world_map(exp_so3({0, 0, back ? M_PI : 0.0}),
                             {1000.0 * place + (back ? 60 : 0), back ? 60.0 : 0.0, 0});
      const Points world = moved(yard(static_cast<std::uint64_t>(place)),
                                 Pose(Eigen::Quaterniond::Identity(), {1000.0 * place, 0, 0}));
      m.points = moved(world, T_world_map.inverse());
      // From the corner straight along a line 10 m (back: 50 m) beside the yard's edge.
      m.T_world_scan.push_back(T_world_map);
      for (int i = 1; i <= 10; ++i) {
        m.T_world_scan.push_back(
            T_world_map * Pose(Eigen::Quaterniond::Identity(), {6.0 * i, back ? 50.0 : 10.0, 1}));
      }
      maps.push_back(m);
    }
  }
  [[nodiscard]] Pose truth(int reference, int query) const {
    return maps[static_cast<std::size_t>(query)].T_world_map().inverse() *
           maps[static_cast<std::size_t>(reference)].T_world_map();
  }
  void report(int reference, int query, int inliers, bool accepted, double off_m) {
    ReportedClosure c;
    c.reference = {0, reference};
    c.query = {0, query};
    c.score = inliers;
    c.accepted = accepted;
    c.T_query_reference = truth(reference, query);
    c.initial_T_query_reference = truth(reference, query);
    c.initial_T_query_reference->translation.x() += off_m;
    closures.push_back(c);
  }
  [[nodiscard]] ClosureEvaluation evaluate() const {
    return evaluate_closures(
        maps, overlapping_pairs(maps, {}), closures,
        [&](const MapKey& key) { return maps[static_cast<std::size_t>(key.map)].points; }, {});
  }
};

TEST(EvaluateClosures, JudgesTrueFalseAndMissed) {
  Drive drive;
  drive.report(0, 4, 30, true, 0.3);
  drive.report(0, 5, 8, false, 0.0);
  drive.report(1, 5, 4, false, 0.0);  // too few inliers
  const ClosureEvaluation e = drive.evaluate();
  ASSERT_EQ(e.references.size(), 2U);
  EXPECT_EQ(e.references[0].reference.map, 0);
  EXPECT_GT(e.references[0].overlap, 0.99);
  EXPECT_EQ(e.references[0].direction, TravelDirection::same);
  EXPECT_EQ(e.references[1].direction, TravelDirection::opposite);
  EXPECT_TRUE(e.references[0].detected);
  EXPECT_TRUE(e.references[0].in_final_graph);
  EXPECT_FALSE(e.references[1].detected);
  EXPECT_EQ(e.at_threshold.true_positives, 1U);
  EXPECT_EQ(e.at_threshold.false_positives, 1U);
  EXPECT_DOUBLE_EQ(e.at_threshold.precision.value(), 0.5);
  EXPECT_DOUBLE_EQ(e.at_threshold.recall.value(), 0.5);
  EXPECT_DOUBLE_EQ(e.final_graph.precision.value(), 1.0);
  // Steps: one of two at precision 1, the other at 2/3.
  EXPECT_NEAR(e.detector.average_precision.value(), 0.5 + 0.5 * 2 / 3, 1e-12);
  EXPECT_EQ(e.eligible, 3U);  // of six maps, three skipped: 0-4, 0-5, 1-5
  EXPECT_NEAR(e.initial_absolute.translation_m.median, 0.3, 1e-9);
  EXPECT_NEAR(e.initial_to_proxy.translation_m.median, 0.3, 0.05);
  EXPECT_NEAR(e.refined_absolute.translation_m.max, 0.0, 1e-9);
  EXPECT_EQ(e.overlap_closures, 1U);
}

TEST(EvaluateClosures, APairWithAWrongPoseIsNotRight) {
  Drive drive;
  drive.report(0, 4, 30, false, 7.0);
  const ClosureEvaluation e = drive.evaluate();
  EXPECT_EQ(e.at_threshold.true_positives, 1U);
  EXPECT_EQ(e.at_threshold.true_wrong_pose, 1U);
  EXPECT_DOUBLE_EQ(e.detector.average_precision.value(), 0.5);
  EXPECT_DOUBLE_EQ(e.with_right_pose.average_precision.value(), 0.0);
  // Shifted by 7 m its overlap is well below that of the reference maps.
  EXPECT_GT(e.overlap_rmse.value(), 0.1);
}

TEST(EvaluateClosures, DriftInsideMapsCountsAtOriginsAndNotWhereTheyMeet) {
  Drive drive;
  // Odometry bent the query map: its later scans lie where they would after a turn of 5 degrees at
  // its origin. A closure that is right where the maps meet is then off at their origins.
  const Pose bend(exp_so3({0, 0, 5 * M_PI / 180}), Eigen::Vector3d::Zero());
  EvaluatedMap& query = drive.maps[4];
  for (std::size_t i = 0; i < query.T_world_scan.size(); ++i) {
    const Pose T = query.T_world_map().inverse() * query.T_world_scan[i];
    query.T_map_scan.push_back(i == 0 ? T : bend * T);
  }
  // They share their way but for the first scan, which is moved away so that they meet beyond it.
  drive.maps[0].T_world_scan[0].translation.z() -= 50;
  drive.report(0, 4, 30, true, 0.0);
  const Pose truth = drive.truth(0, 4);
  drive.closures[0].initial_T_query_reference = bend * truth;
  const std::vector<PairOverlap> pairs{{{0, 0}, {0, 4}, 0.9, TravelDirection::same, 0.0}};
  const ClosureEvaluation e = evaluate_closures(drive.maps, pairs, drive.closures, {}, {});
  ASSERT_EQ(e.judged.size(), 1U);
  EXPECT_NEAR(e.judged[0].initial_meeting->translation_m, 0.0, 1e-6);
  EXPECT_NEAR(e.judged[0].initial_meeting->rotation_deg, 0.0, 1e-6);
  EXPECT_NEAR(e.judged[0].initial_origin->rotation_deg, 5.0, 1e-6);
  EXPECT_TRUE(e.judged[0].initial_right);
}

TEST(EvaluateClosures, PairsNearTheThresholdAreUncertainAndLeftOutOfTheCertain) {
  Drive drive;
  drive.report(0, 4, 30, false, 0.0);
  drive.report(0, 5, 20, false, 0.0);
  drive.report(1, 5, 10, false, 0.0);
  const std::vector<PairOverlap> pairs{{{0, 0}, {0, 4}, 0.29, TravelDirection::same, 0.0},
                                       {{0, 0}, {0, 5}, 0.21, TravelDirection::same, 0.0},
                                       {{0, 1}, {0, 5}, 0.31, TravelDirection::same, 0.0}};
  const ClosureEvaluation e = evaluate_closures(drive.maps, pairs, drive.closures, {}, {});
  EXPECT_EQ(e.references.size(), 2U);
  EXPECT_EQ(e.uncertain_references(), 1U);
  EXPECT_NEAR(e.detector.average_precision.value(), 0.5 + 0.5 * 2 / 3, 1e-12);
  EXPECT_EQ(e.certain.references, 1U);
  EXPECT_DOUBLE_EQ(e.certain.average_precision.value(), 1.0);
}

TEST(EvaluateClosures, LeavesOutMapsWithoutGroundTruth) {
  Drive drive;
  drive.maps[4].T_world_scan.clear();
  drive.closures.push_back({{0, 0}, {0, 4}, true, false, 30.0, Pose(), Pose()});
  const ClosureEvaluation e = drive.evaluate();
  EXPECT_EQ(e.dropped, 1U);
  EXPECT_EQ(e.eligible, 2U);
  EXPECT_TRUE(e.judged.empty());
}

TEST(EvaluateClosures, BetweenSessionsCountsOnlyPairsOfTwo) {
  ReferenceOptions options;
  options.pairs = "between";
  EXPECT_TRUE(is_eligible({0, 7}, {1, 0}, options));
  EXPECT_FALSE(is_eligible({1, 0}, {0, 7}, options));
  EXPECT_FALSE(is_eligible({0, 0}, {0, 7}, options));
}

TEST(EvaluateClosures, RefusesClosuresOfUnknownMaps) {
  Drive drive;
  drive.report(0, 4, 30, false, 0.0);
  drive.closures[0].query.map = 77;
  EXPECT_THROW((void)drive.evaluate(), InputError);
}

}  // namespace
}  // namespace groundloop
