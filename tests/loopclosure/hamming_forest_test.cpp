#include "loopclosure/hamming_forest.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "loopclosure/hamming.hpp"

namespace groundloop {
namespace {

std::vector<Descriptor> random_descriptors(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::vector<Descriptor> result(n);
  for (Descriptor& d : result) {
    for (std::uint64_t& word : d) word = rng();
  }
  return result;
}

Descriptor flip_bits(Descriptor d, int count, std::mt19937_64& rng) {
  for (int flipped = 0; flipped < count;) {
    const std::size_t bit = rng() % 256;
    const std::uint64_t mask = 1ULL << (bit % 64);
    d[bit / 64] ^= mask;
    ++flipped;
  }
  return d;
}

HammingForest forest_of(const std::vector<Descriptor>& descriptors, std::size_t trees,
                        std::size_t leaf_size) {
  HammingForest forest(trees, leaf_size);
  forest.insert(descriptors);
  return forest;
}

class ForestOf : public ::testing::TestWithParam<int> {
 protected:
  std::size_t trees() const { return static_cast<std::size_t>(GetParam()); }
};

TEST_P(ForestOf, LeavesHoldAtMostTheirSizeAndTreesAreBalanced) {
  const HammingForest forest = forest_of(random_descriptors(20000, 1), trees(), 100);
  EXPECT_EQ(forest.size(), 20000U);
  EXPECT_LE(forest.largest_leaf(), 100U);
  // 2^8 leaves would hold 25 600; splits on bits of mean one half keep the depth near that.
  EXPECT_LE(forest.depth(), 11U);
  EXPECT_GE(forest.leaves(), 200U);
}

TEST_P(ForestOf, OneLeafIsAnExhaustiveSearch) {
  const std::vector<Descriptor> stored = random_descriptors(90, 2);
  const HammingForest forest = forest_of(stored, trees(), 100);
  std::vector<HammingForest::Match> matches;
  for (const Descriptor& query : random_descriptors(20, 3)) {
    forest.search(query, 120, matches);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < stored.size(); ++i) {
      if (hamming_distance(query, stored[i]) <= 120) expected.push_back(i);
    }
    ASSERT_EQ(matches.size(), expected.size());
    for (std::size_t i = 0; i < matches.size(); ++i) {
      EXPECT_EQ(matches[i].id, expected[i]);
      EXPECT_EQ(matches[i].distance, hamming_distance(query, stored[expected[i]]));
    }
  }
}

TEST_P(ForestOf, FindsEveryStoredDescriptorItself) {
  const std::vector<Descriptor> stored = random_descriptors(3000, 4);
  const HammingForest forest = forest_of(stored, trees(), 50);
  std::vector<HammingForest::Match> matches;
  for (std::uint32_t i = 0; i < stored.size(); ++i) {
    forest.search(stored[i], 0, matches);
    ASSERT_EQ(matches.size(), 1U);
    EXPECT_EQ(matches[0].id, i);
  }
}

TEST_P(ForestOf, ReportsNoMatchThatAnExhaustiveSearchDoesNotAndNoneTwice) {
  const std::vector<Descriptor> stored = random_descriptors(2000, 5);
  const HammingForest forest = forest_of(stored, trees(), 100);
  std::mt19937_64 rng(6);
  std::vector<HammingForest::Match> matches;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Descriptor query = flip_bits(stored[i], 20, rng);
    forest.search(query, 110, matches);
    for (std::size_t k = 0; k < matches.size(); ++k) {
      EXPECT_EQ(matches[k].distance, hamming_distance(query, stored[matches[k].id]));
      EXPECT_LE(matches[k].distance, 110);
      if (k > 0) {
        EXPECT_LT(matches[k - 1].id, matches[k].id);
      }
    }
  }
}

TEST_P(ForestOf, EqualDescriptorsStayInOneLeafAndArePartedOnceOneDiffers) {
  const Descriptor one = random_descriptors(1, 7)[0];
  HammingForest forest(trees(), 10);
  for (int i = 0; i < 35; ++i) forest.insert(std::span(&one, 1));
  EXPECT_EQ(forest.leaves(), 1U);
  Descriptor other = one;
  other[0] ^= 1;  // bit 0 is one of the first tree's
  for (int i = 35; i < 80; ++i) forest.insert(std::span(&other, 1));
  EXPECT_EQ(forest.leaves(), 2U);
  std::vector<HammingForest::Match> matches;
  forest.search(one, 0, matches);
  EXPECT_EQ(matches.size(), 35U);
}

TEST_P(ForestOf, WithoutDescriptorsHasNoMatches) {
  const HammingForest forest(trees());
  std::vector<HammingForest::Match> matches{{1, 2}};
  forest.search(Descriptor{}, 256, matches);
  EXPECT_TRUE(matches.empty());
}

INSTANTIATE_TEST_SUITE_P(Trees, ForestOf, ::testing::Values(1, 8));

double recall(std::size_t trees, int flipped) {
  const std::vector<Descriptor> stored = random_descriptors(20000, 8);
  const HammingForest forest = forest_of(stored, trees, 100);
  std::mt19937_64 rng(9);
  std::vector<HammingForest::Match> matches;
  int found = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    forest.search(flip_bits(stored[i], flipped, rng), 50, matches);
    found += std::any_of(matches.begin(), matches.end(), [&](const auto& m) { return m.id == i; });
  }
  return found / 2000.0;
}

TEST(HammingForest, WithTreesGivenUpIsAForestOfTheOthers) {
  const std::vector<Descriptor> stored = random_descriptors(3000, 11);
  HammingForest forest(16, 50);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (i == 1000) forest.keep_trees(4);
    forest.insert(std::span(&stored[i], 1));
  }
  EXPECT_EQ(forest.trees(), 4U);
  forest.keep_trees(8);
  EXPECT_EQ(forest.trees(), 4U);
  HammingForest late(16, 50);
  for (const Descriptor& d : stored) late.insert(std::span(&d, 1));
  late.keep_trees(4);
  std::mt19937_64 rng(12);
  std::vector<HammingForest::Match> matches, expected;
  for (std::size_t i = 0; i < 100; ++i) {
    const Descriptor query = flip_bits(stored[i], 20, rng);
    forest.search(query, 60, matches);
    late.search(query, 60, expected);
    ASSERT_EQ(matches.size(), expected.size());
    for (std::size_t m = 0; m < matches.size(); ++m) EXPECT_EQ(matches[m].id, expected[m].id);
  }
}

TEST(HammingForest, SplitsOnlyOnBitsThatAreBalancedEnough) {
  // Bit 7 is set in one of four descriptors, every other bit in none: 0.25 from one half.
  std::vector<Descriptor> stored(80, Descriptor{});
  for (std::size_t i = 0; i < stored.size(); i += 4) stored[i][0] = 1U << 7;
  HammingForest strict(1, 50, 0.24), lax(1, 50, 0.25);
  strict.insert(stored);
  lax.insert(stored);
  EXPECT_EQ(strict.leaves(), 1U);
  EXPECT_EQ(lax.leaves(), 2U);
  EXPECT_EQ(lax.largest_leaf(), 60U);
  // Once enough have come to balance it, it is split.
  strict.insert(std::vector<Descriptor>(40, stored[0]));
  EXPECT_EQ(strict.leaves(), 2U);
}

TEST(HammingForest, RecallFollowsFromTheBitsOfTheWay) {
  // A tree over 20 000 descriptors decides on about 8 bits, each right with probability
  // 1 - 25 / 256; a forest of eight misses where every tree does.
  const double one = std::pow(1 - 25.0 / 256, 8);
  EXPECT_NEAR(recall(1, 25), one, 0.08);
  EXPECT_GT(recall(8, 25), 0.95);
  EXPECT_GT(1 - std::pow(1 - one, 8), 0.95);
}

}  // namespace
}  // namespace groundloop
