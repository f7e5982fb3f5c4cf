#include "backend/judging/pairwise_consistency.hpp"

#include <bit>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "backend/graph/odometry_information.hpp"
#include "backend/judging/maximum_clique.hpp"
#include "tests/support/false_closures.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

int largest_by_enumeration(const Adjacency& graph) {
  int best = 0;
  for (unsigned set = 0; set < 1U << graph.size(); ++set) {
    bool clique = true;
    for (std::size_t i = 0; clique && i < graph.size(); ++i) {
      for (std::size_t j = 0; clique && j < i; ++j) {
        clique = !((set >> i) & (set >> j) & 1U) || graph.joined(i, j);
      }
    }
    if (clique) best = std::max(best, std::popcount(set));
  }
  return best;
}

TEST(MaximumClique, IsAsLargeAsEnumerationSays) {
  std::mt19937 generator(1);
  for (int trial = 0; trial < 30; ++trial) {
    Adjacency graph(12);
    for (std::size_t i = 0; i < 12; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (generator() % 100 < 30U + 2U * static_cast<unsigned>(trial)) graph.join(i, j);
      }
    }
    const Clique clique = maximum_clique(graph, std::vector<char>(12, 1));
    EXPECT_TRUE(clique.proven);
    EXPECT_EQ(static_cast<int>(clique.members.size()), largest_by_enumeration(graph));
    for (const int i : clique.members) {
      for (const int j : clique.members) EXPECT_TRUE(i == j || graph.joined(i, j));
    }
  }
}

TEST(MaximumClique, FindsAPlantedOneAcrossWords) {
  std::mt19937 generator(2);
  Adjacency graph(300);
  for (std::size_t i = 0; i < 300; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool planted = i % 10 == 3 && j % 10 == 3;
      if (planted || generator() % 100 < 20) graph.join(i, j);
    }
  }
  const Clique clique = maximum_clique(graph, std::vector<char>(300, 1));
  EXPECT_GE(clique.members.size(), 30u);
  std::vector<char> without(300, 1);
  for (int i = 3; i < 300; i += 10) without[i] = 0;
  for (const int i : maximum_clique(graph, without).members) EXPECT_NE(i % 10, 3);
}

TEST(MaximumClique, AcceptsAnEmptyGraph) {
  EXPECT_TRUE(maximum_clique(Adjacency(0), {}).members.empty());
}

class Drive : public ::testing::Test {
 protected:
  // Two laps; true closures each 40 poses, from the later to the earlier pose.
  void SetUp() override {
    for (const GraphVertex& vertex : simulated_.graph.vertices) odometry_.push_back(vertex.pose);
    chain_ = std::make_unique<OdometryChain>(odometry_, testing::simulated_drift());
    std::mt19937_64 generator(9);
    for (int from = kLap; from < 2 * kLap; from += 40) {
      const Pose truth = simulated_.truth[from].inverse() * simulated_.truth[from - kLap];
      const Pose noise = exp_se3(testing::gaussian(generator, testing::closure_covariance()));
      closures_.push_back({from, from - kLap, {truth * noise, testing::closure_covariance()}});
    }
  }
  ChainFunction chain() {
    return [this](int from, int to) {
      return chain_->between(static_cast<std::size_t>(from), static_cast<std::size_t>(to));
    };
  }

  static constexpr int kLap = 600;
  testing::SimulatedGraph simulated_ = testing::simulate_graph(2 * kLap, 0, kLap, 3);
  std::vector<Pose> odometry_;
  std::unique_ptr<OdometryChain> chain_;
  std::vector<PairwiseClosure> closures_;
};

TEST_F(Drive, DistancesOfTrueClosuresFollowTheChiSquareDistribution) {
  double sum = 0.0;
  int pairs = 0;
  for (std::size_t i = 0; i < closures_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j, ++pairs) {
      sum += pairwise_distance(closures_[i], closures_[j], chain(), chain());
    }
  }
  // Mean 6 where covariances are right; pairs share noise, so the mean itself scatters.
  EXPECT_GT(sum / pairs, 3.0);
  EXPECT_LT(sum / pairs, 10.0);
}

TEST_F(Drive, FalseClosuresAreNotInTheLargestSet) {
  const std::size_t true_ones = closures_.size();
  PoseGraph planted;
  testing::FalseClosures generator(simulated_.truth, testing::closure_covariance().inverse(), 5);
  generator.add_near(planted, 20, 1, 1, kLap);
  generator.add_groups(planted, 2, 5, 4, 100);
  for (const GraphEdge& edge : planted.edges) {
    closures_.push_back({edge.from, edge.to, {edge.T_from_to, testing::closure_covariance()}});
  }
  const ConsistentSets result = consistent_sets(closures_, chain(), chain());
  EXPECT_TRUE(result.proven);
  // Of 15 true ones a pair or two miss the 99 % quantile.
  EXPECT_GE(result.sets.front().size(), true_ones - 3);
  for (const int i : result.sets.front()) EXPECT_LT(static_cast<std::size_t>(i), true_ones);
  std::size_t members = 0;
  for (const auto& set : result.sets) members += set.size();
  EXPECT_EQ(members, closures_.size());
}

TEST_F(Drive, WorksBetweenTwoSessionsInFramesOfTheirOwn) {
  // The second lap as a session of its own, far away and turned.
  const Pose elsewhere(Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ())),
                       {500, -300, 20});
  std::vector<Pose> second;
  for (int i = kLap; i < 2 * kLap; ++i) second.push_back(elsewhere * odometry_[i]);
  const OdometryChain second_chain(second, testing::simulated_drift());
  for (PairwiseClosure& closure : closures_) closure.from -= kLap;
  closures_[4].T_from_to.T_from_to.translation.x() += 8.0;
  const ConsistentSets result = consistent_sets(
      closures_,
      [&](int from, int to) {
        return second_chain.between(static_cast<std::size_t>(from), static_cast<std::size_t>(to));
      },
      chain());
  EXPECT_GE(result.sets.front().size(), closures_.size() - 3);
  for (const int i : result.sets.front()) EXPECT_NE(i, 4);
}

}  // namespace
}  // namespace groundloop
