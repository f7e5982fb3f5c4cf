#include "loopclosure/hamming_tree.hpp"

#include <algorithm>
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
    const Descriptor before = d;
    d[bit / 64] ^= 1ULL << (bit % 64);
    flipped += before != d ? 1 : 0;
  }
  return d;
}

HammingTree tree_of(const std::vector<Descriptor>& descriptors, std::size_t leaf_size) {
  HammingTree tree(leaf_size);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    tree.insert(descriptors[i], static_cast<std::uint32_t>(i));
  }
  return tree;
}

TEST(HammingTree, LeavesHoldAtMostTheirSizeAndTheTreeIsBalanced) {
  const HammingTree tree = tree_of(random_descriptors(20000, 1), 100);
  EXPECT_EQ(tree.size(), 20000U);
  EXPECT_LE(tree.largest_leaf(), 100U);
  // 2^8 leaves would hold 25 600; splits on bits of mean one half keep the depth near that.
  EXPECT_LE(tree.depth(), 11U);
  EXPECT_GE(tree.leaves(), 200U);
}

TEST(HammingTree, OneLeafIsAnExhaustiveSearch) {
  const std::vector<Descriptor> stored = random_descriptors(90, 2);
  const HammingTree tree = tree_of(stored, 100);
  std::vector<HammingTree::Match> matches;
  for (const Descriptor& query : random_descriptors(20, 3)) {
    tree.search(query, 120, matches);
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

TEST(HammingTree, FindsEveryStoredDescriptorItself) {
  const std::vector<Descriptor> stored = random_descriptors(3000, 4);
  const HammingTree tree = tree_of(stored, 50);
  std::vector<HammingTree::Match> matches;
  for (std::uint32_t i = 0; i < stored.size(); ++i) {
    tree.search(stored[i], 0, matches);
    ASSERT_EQ(matches.size(), 1U);
    EXPECT_EQ(matches[0].id, i);
  }
}

TEST(HammingTree, ReportsNoMatchThatAnExhaustiveSearchDoesNot) {
  const std::vector<Descriptor> stored = random_descriptors(2000, 5);
  const HammingTree tree = tree_of(stored, 100);
  std::mt19937_64 rng(6);
  std::vector<HammingTree::Match> matches;
  std::size_t found = 0;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Descriptor query = flip_bits(stored[i], 20, rng);
    tree.search(query, 50, matches);
    for (const auto& match : matches) {
      EXPECT_EQ(match.distance, hamming_distance(query, stored[match.id]));
      EXPECT_LE(match.distance, 50);
      found += match.id == i ? 1 : 0;
    }
  }
  // A neighbour is found where none of the about five bits of the path differ: (1 - 20/256)^5 of
  // the time, up to what balance the splits reach.
  EXPECT_GT(found, 250U);
}

TEST(HammingTree, EqualDescriptorsStayInOneLeafAndArePartedOnceOneDiffers) {
  const Descriptor one = random_descriptors(1, 7)[0];
  HammingTree tree(10);
  for (std::uint32_t i = 0; i < 35; ++i) tree.insert(one, i);
  EXPECT_EQ(tree.leaves(), 1U);
  Descriptor other = one;
  other[0] ^= 1;
  for (std::uint32_t i = 35; i < 80; ++i) tree.insert(other, i);
  std::vector<HammingTree::Match> matches;
  tree.search(one, 0, matches);
  EXPECT_EQ(matches.size(), 35U);
}

TEST(HammingTree, AnEmptyTreeHasNoMatches) {
  const HammingTree tree;
  std::vector<HammingTree::Match> matches{{1, 2}};
  tree.search(Descriptor{}, 256, matches);
  EXPECT_TRUE(matches.empty());
}

}  // namespace
}  // namespace groundloop
