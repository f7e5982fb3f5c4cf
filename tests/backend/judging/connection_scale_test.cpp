// Two drives over the same circuit, each with odometry that errs a known number of times as much as
// it states, and closures between them of known truth.
#include "backend/judging/connection_scale.hpp"

#include <random>

#include <gtest/gtest.h>

#include "backend/judging/closure_groups.hpp"
#include "backend/judging/graph_evidence.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

constexpr int kPoses = 400;
constexpr int kLap = 250;

struct Scene {
  FramePair frames;
  std::vector<Pose> truth;  // of the poses of either drive
  std::vector<PairwiseClosure> between;

  // Closures from y to x at the same places, with errors as their covariance says.
  void add_true(int count, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    for (int k = 0; k < count; ++k) {
      const int from = static_cast<int>(generator() % (kPoses - 10));
      const int to = from + static_cast<int>(generator() % 10);
      const Matrix6d covariance = testing::closure_covariance();
      between.push_back(
          {kPoses + from,
           to,
           {truth[from].inverse() * truth[to] * exp_se3(testing::gaussian(generator, covariance)),
            covariance}});
    }
  }

  // Places taken for others as streets are: along the other way's heading or against it, level.
  void add_false(int count, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> along(-50.0, 50.0);
    for (int left = count; left > 0;) {
      const Pose T(exp_so3({0.0, 0.0, generator() % 2 == 0 ? 0.0 : M_PI}),
                   {along(generator), 0.0, 0.0});
      const auto from = static_cast<int>(generator() % kPoses);
      const auto to = static_cast<int>(generator() % kPoses);
      const Pose error = T.inverse() * truth[from].inverse() * truth[to];
      if (error.translation.norm() < 20.0) continue;
      between.push_back({kPoses + from, to, {T, testing::closure_covariance()}});
      --left;
    }
  }

  [[nodiscard]] std::size_t true_in_first_set(const ConnectionTrial& trial, int count) const {
    const std::vector<int>& set = trial.found.sets.front();
    return static_cast<std::size_t>(
        std::count_if(set.begin(), set.end(), [&](int i) { return i < count; }));
  }
};

// `own` closures of x with itself a lap later.
Scene scene(double drift_x, double drift_y, int own, std::uint64_t seed) {
  Scene result;
  const testing::SimulatedGraph x = testing::simulate_graph(kPoses, own, kLap, seed, drift_x);
  const testing::SimulatedGraph y = testing::simulate_graph(kPoses, 0, kLap, seed + 77, drift_y);
  result.truth = x.truth;
  result.frames.graph = x.graph;
  result.frames.in_y.assign(kPoses, 0);
  // y stands in a frame of its own.
  const Pose T_y_world(exp_so3({0.01, -0.02, 1.0}), {30.0, -200.0, 3.0});
  for (GraphVertex vertex : y.graph.vertices) {
    vertex.id += kPoses;
    vertex.pose = T_y_world * vertex.pose;
    result.frames.graph.vertices.push_back(vertex);
    result.frames.in_y.push_back(1);
  }
  for (GraphEdge edge : y.graph.edges) {
    edge.from += kPoses;
    edge.to += kPoses;
    result.frames.graph.edges.push_back(edge);
  }
  return result;
}

TEST(ConnectionScale, FindsASessionWhoseOdometryErrsMoreThanItSays) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scene s = scene(1.0, 4.0, 10, seed);
    s.add_true(10, seed);
    const ConnectionTrial stated = connection_at(s.frames, s.between, 1.0, 1.0, {});
    ASSERT_LT(stated.found.sets.front().size(), 8U) << "the case is too easy";
    const ConnectionTrial best = best_connection(s.frames, s.between, {});
    EXPECT_EQ(best.found.sets.front().size(), 10U) << seed;
    EXPECT_GT(best.scale_y, 2.5) << seed;
    EXPECT_LT(best.scale_y, 6.0) << seed;
    // It met its own way again, and its own closures fit.
    EXPECT_LT(best.scale_x, 1.5) << seed;
  }
}

TEST(ConnectionScale, StaysAtOneWhereOdometryErrsAsStated) {
  for (const std::uint64_t seed : {4U, 5U, 6U}) {
    Scene s = scene(1.0, 1.0, 2, seed);
    s.add_true(6, seed);
    s.add_false(8, seed);
    const ConnectionTrial best = best_connection(s.frames, s.between, {});
    EXPECT_LT(std::max(best.scale_x, best.scale_y), 1.5) << seed;
    EXPECT_GE(s.true_in_first_set(best, 6), 5U) << seed;
    EXPECT_EQ(best.found.sets.front().size(), s.true_in_first_set(best, 6)) << seed;
  }
}

TEST(ConnectionScale, TakesNoFalseClosureIntoTheSetOfAPoorSession) {
  for (const std::uint64_t seed : {7U, 8U, 9U}) {
    Scene s = scene(1.0, 3.0, 2, seed);
    s.add_true(8, seed);
    s.add_false(8, seed);
    const ConnectionTrial best = best_connection(s.frames, s.between, {});
    EXPECT_GE(s.true_in_first_set(best, 8), 7U) << seed;
    EXPECT_EQ(best.found.sets.front().size(), s.true_in_first_set(best, 8)) << seed;
  }
}

TEST(ConnectionScale, GathersNoThreeFalseClosuresOfStreets) {
  int gathered = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Scene s = scene(1.0, 1.0, 1, 20 + seed);
    s.add_false(10, seed);
    gathered += best_connection(s.frames, s.between, {}).found.sets.front().size() >= 3 ? 1 : 0;
  }
  EXPECT_EQ(gathered, 0);
}

TEST(GraphEvidence, OfTwoMeasurementsOfOnePoseIsTheDensityOfTheirDifference) {
  // One pose measured twice, 0.03 m apart, with variances 0.01 and 0.04 each in all six directions.
  PoseGraph graph;
  graph.vertices = {{0, Pose(), true}, {1, Pose(), false}};
  Pose other;
  other.translation.x() = 0.03;
  graph.edges.push_back({0, 1, Pose(), 100.0 * Matrix6d::Identity(), EdgeKind::odometry});
  graph.edges.push_back({0, 1, other, 25.0 * Matrix6d::Identity(), EdgeKind::odometry});
  const double expected = -0.5 * 0.0009 / 0.05 - 3.0 * std::log(2.0 * M_PI * 0.05);
  EXPECT_NEAR(log_marginal_density(graph), expected, 1e-4);
  // A chain alone explains itself, whatever its covariances.
  graph.edges.pop_back();
  EXPECT_NEAR(log_marginal_density(graph), 0.0, 1e-9);
}

}  // namespace
}  // namespace groundloop
