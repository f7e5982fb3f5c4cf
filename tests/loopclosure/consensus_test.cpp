#include "loopclosure/consensus.hpp"

#include <cmath>
#include <random>
#include <set>
#include <span>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

// Matches built so that it is known which are inliers of which motion.
struct Scene {
  MapDescription query, reference;
  std::vector<KeypointMatch> matches;
  std::mt19937_64 rng;

  explicit Scene(std::uint64_t seed) : rng(seed) {}
  Eigen::Vector2d anywhere() {
    std::uniform_real_distribution<double> uniform(-80, 80);
    const double x = uniform(rng);
    return {x, uniform(rng)};
  }
  void add(const Eigen::Vector2d& q, const Eigen::Vector2d& r, double turn) {
    const auto index = static_cast<std::uint32_t>(matches.size());
    std::uniform_real_distribution<double> uniform(-3, 3);
    const double orientation = uniform(rng);
    query.keypoints.push_back(q.cast<float>());
    query.orientations.push_back(static_cast<float>(orientation + turn));
    reference.keypoints.push_back(r.cast<float>());
    reference.orientations.push_back(static_cast<float>(orientation));
    query.descriptors.push_back({rng(), rng(), rng(), rng()});
    reference.descriptors.push_back(query.descriptors.back());
    reference.descriptors.back()[0] ^= (1U << 20) - 1;
    matches.push_back({index, index, 20});
  }
  void add_inliers(int count, const PlanarTransform& T, double noise) {
    std::uniform_real_distribution<double> uniform(-noise, noise);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d r = anywhere();
      const double dx = uniform(rng), dy = uniform(rng);
      add(T * r + Eigen::Vector2d(dx, dy), r, T.angle + 0.1 * dx);
    }
  }
  void add_outliers(int count) {
    std::uniform_real_distribution<double> uniform(-3, 3);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d q = anywhere();
      add(q, anywhere(), uniform(rng));
    }
  }
  // A mirror image of one motion: near it no rotation agrees with more than a few.
  void add_mirrored(int count) {
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d r = anywhere();
      add({r.x() + 10, -r.y()}, r, 0.0);
    }
  }
};

class ConsensusMethod : public ::testing::TestWithParam<const char*> {
 protected:
  ConsensusOptions options() const {
    ConsensusOptions o;
    o.method = GetParam();
    return o;
  }
};

TEST_P(ConsensusMethod, FindsSixInliersAmongAHundredMatches) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Scene scene(seed);
    const PlanarTransform T{0.3 * static_cast<double>(seed) - 3, {15, -20}};
    scene.add_outliers(54);
    scene.add_inliers(6, T, 0.3);
    scene.add_outliers(40);
    const Consensus c =
        find_consensus(scene.query, scene.reference, scene.matches, options(), seed);
    std::set<std::uint32_t> found;
    for (const KeypointMatch& m : c.inliers) found.insert(m.query);
    for (std::uint32_t i = 54; i < 60; ++i) EXPECT_TRUE(found.count(i)) << "seed " << seed;
    EXPECT_NEAR(wrap_angle(c.T_query_reference.angle - T.angle), 0, 0.03);
    EXPECT_LT((c.T_query_reference.translation - T.translation).norm(), 1.5);
  }
}

TEST_P(ConsensusMethod, IsNotTakenInByAMirrorImage) {
  Scene scene(5);
  const PlanarTransform T{1.0, {5, 5}};
  scene.add_mirrored(40);
  scene.add_inliers(10, T, 0.3);
  const Consensus c = find_consensus(scene.query, scene.reference, scene.matches, options(), 1);
  EXPECT_NEAR(c.T_query_reference.angle, 1.0, 0.03);
  EXPECT_GE(c.inliers.size(), 10U);
  EXPECT_LE(c.inliers.size(), 13U);
  EXPECT_NEAR(rotation_matrix(c.T_query_reference).determinant(), 1.0, 1e-12);
}

TEST_P(ConsensusMethod, CountsAKeypointOnce) {
  Scene scene(6);
  const PlanarTransform T{-2.0, {0, 40}};
  scene.add_inliers(8, T, 0.2);
  // Every feature also matches its neighbour's twin.
  std::vector<KeypointMatch> doubled = scene.matches;
  for (std::uint32_t i = 0; i < 8; ++i) {
    scene.query.keypoints.push_back(scene.query.keypoints[i] + Eigen::Vector2f(0.4F, 0.0F));
    scene.query.orientations.push_back(scene.query.orientations[i]);
    scene.query.descriptors.push_back(scene.query.descriptors[i]);
    scene.query.descriptors.back()[1] ^= (1U << 25) - 1;
    doubled.push_back({8 + i, i, 45});
  }
  const Consensus c = find_consensus(scene.query, scene.reference, doubled, options(), 1);
  ASSERT_EQ(c.inliers.size(), 8U);
  for (const KeypointMatch& m : c.inliers) EXPECT_EQ(m.distance, 20);
}

TEST_P(ConsensusMethod, DegenerateMatchesHaveDefinedResults) {
  Scene scene(7);
  EXPECT_TRUE(find_consensus(scene.query, scene.reference, {}, options()).inliers.empty());
  scene.add_outliers(1);
  EXPECT_TRUE(
      find_consensus(scene.query, scene.reference, scene.matches, options()).inliers.empty());
  Scene equal(8);
  for (int i = 0; i < 10; ++i) equal.add({1, 1}, {2, 2}, 0.0);
  const Consensus c = find_consensus(equal.query, equal.reference, equal.matches, options());
  EXPECT_TRUE(std::isfinite(c.T_query_reference.angle));
  EXPECT_TRUE(c.T_query_reference.translation.allFinite());
}

INSTANTIATE_TEST_SUITE_P(Methods, ConsensusMethod, ::testing::Values("voting", "ransac"));

TEST(Consensus, CountsWhatTheSearchMissedWhereItMeetsUnderTheAlignment) {
  Scene scene(9);
  const PlanarTransform T{0.4, {-12, 30}};
  scene.add_inliers(40, T, 0.3);
  // The search found eight of forty.
  const std::span<const KeypointMatch> found(scene.matches.data(), 8);
  EXPECT_EQ(find_consensus(scene.query, scene.reference, found, {}).inliers.size(), 40U);
  ConsensusOptions unguided;
  unguided.guided_bits = 0;
  EXPECT_EQ(find_consensus(scene.query, scene.reference, found, unguided).inliers.size(), 8U);
}

TEST(Consensus, KeypointsThatTurnOtherwiseAreNoInliers) {
  Scene scene(10);
  const PlanarTransform T{0.4, {-12, 30}};
  scene.add_inliers(10, T, 0.3);
  for (std::size_t i = 0; i < 4; ++i) scene.query.orientations[i] += 1.0F;
  EXPECT_EQ(find_consensus(scene.query, scene.reference, scene.matches, {}).inliers.size(), 6U);
  ConsensusOptions blind;
  blind.orientation_gate_deg = 180;
  EXPECT_EQ(find_consensus(scene.query, scene.reference, scene.matches, blind).inliers.size(), 10U);
}

TEST(Consensus, VotingNeverHasFewerInliersThanTheConstructedSet) {
  // Sets at the very edge of the radius, among many matches, in every direction.
  for (std::uint64_t seed = 100; seed < 130; ++seed) {
    Scene scene(seed);
    const PlanarTransform T{static_cast<double>(seed), {-30, 10}};
    scene.add_inliers(6, T, 0.9);
    scene.add_outliers(200);
    for (const int guided_bits : {0, 55}) {
      ConsensusOptions options;
      options.guided_bits = guided_bits;
      const Consensus c = find_consensus(scene.query, scene.reference, scene.matches, options);
      EXPECT_GE(c.inliers.size(), 6U) << seed;
    }
  }
}

TEST(Consensus, AsThePaperHasItKeypointsCountAsOftenAsTheyMatchAndOneFitIsTheLast) {
  ConsensusOptions paper;
  paper.method = "ransac";
  paper.trials = 74;
  paper.max_matches = 0;
  paper.unique_keypoints = false;
  paper.refinement = false;
  paper.orientation_gate_deg = 180;
  paper.guided_bits = 0;
  Scene scene(11);
  const PlanarTransform T{0.4, {-12, 30}};
  scene.add_inliers(10, T, 0.3);
  std::vector<KeypointMatch> doubled = scene.matches;
  doubled.insert(doubled.end(), scene.matches.begin(), scene.matches.end());
  const Consensus all = find_consensus(scene.query, scene.reference, doubled, paper);
  EXPECT_EQ(all.inliers.size(), 20U);
  EXPECT_NEAR(wrap_angle(all.T_query_reference.angle - T.angle), 0, 0.03);
  paper.unique_keypoints = true;
  EXPECT_EQ(find_consensus(scene.query, scene.reference, doubled, paper).inliers.size(), 10U);
}

TEST(Consensus, TooFewTrialsMissWhatTheSeedDecides) {
  Scene scene(12);
  scene.add_inliers(6, {0.4, {-12, 30}}, 0.3);
  scene.add_outliers(120);
  ConsensusOptions few;
  few.method = "ransac";
  few.guided_bits = 0;
  few.trials = 200;  // each hits with probability 30 / (126 * 125): 0.32 in all
  int hits = 0;
  for (int seed = 0; seed < 60; ++seed) {
    few.seed = seed;
    const Consensus c = find_consensus(scene.query, scene.reference, scene.matches, few);
    hits += c.inliers.size() >= 6 ? 1 : 0;
  }
  EXPECT_GT(hits, 8);
  EXPECT_LT(hits, 32);
}

TEST(Consensus, RansacTrialsBoundTheProbabilityOfAMiss) {
  for (const std::size_t n : {10U, 50U, 200U}) {
    const std::size_t trials = ransac_trials(n, 6, 1e-3);
    const double hit = 6.0 * 5.0 / (static_cast<double>(n) * static_cast<double>(n - 1));
    EXPECT_LE(std::pow(1 - hit, static_cast<double>(trials)), 1e-3);
    EXPECT_GT(std::pow(1 - hit, static_cast<double>(trials - 1)), 1e-3);
  }
  EXPECT_EQ(ransac_trials(6, 6, 1e-3), 1U);
  EXPECT_EQ(ransac_trials(1, 6, 1e-3), 0U);
}

}  // namespace
}  // namespace groundloop
