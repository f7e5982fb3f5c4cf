#include "loopclosure/hamming.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "loopclosure/features.hpp"

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

std::size_t bit_by_bit(const Descriptor& a, const Descriptor& b) {
  std::size_t count = 0;
  for (int i = 0; i < 256; ++i) count += descriptor_bit(a, i) != descriptor_bit(b, i) ? 1U : 0U;
  return count;
}

TEST(Hamming, EveryKernelCountsDifferingBits) {
  std::vector<Descriptor> stored = random_descriptors(67, 1);
  const Descriptor query = random_descriptors(1, 2)[0];
  stored.push_back(query);
  stored.push_back({~query[0], ~query[1], ~query[2], ~query[3]});
  for (const HammingKernel& kernel : hamming_kernels()) {
    std::vector<std::uint16_t> distances(stored.size());
    kernel.distances(query, stored.data(), nullptr, stored.size(), distances.data());
    for (std::size_t i = 0; i < stored.size(); ++i) {
      EXPECT_EQ(distances[i], bit_by_bit(query, stored[i])) << kernel.name << ", " << i;
    }
    std::vector<std::uint32_t> backwards;
    for (std::uint32_t i = 0; i < stored.size(); ++i) {
      backwards.push_back(static_cast<std::uint32_t>(stored.size()) - 1 - i);
    }
    std::vector<std::uint16_t> gathered(stored.size());
    kernel.distances(query, stored.data(), backwards.data(), stored.size(), gathered.data());
    EXPECT_TRUE(std::equal(gathered.rbegin(), gathered.rend(), distances.begin())) << kernel.name;
    EXPECT_EQ(distances[67], 0) << kernel.name;
    EXPECT_EQ(distances[68], 256) << kernel.name;
  }
}

TEST(Pruning, DropsExactlyThoseWithANeighbourWithinTheBound) {
  std::vector<Descriptor> descriptors = random_descriptors(40, 3);
  descriptors[7] = descriptors[3];
  descriptors[7][1] ^= (1ULL << 35) - 1;  // 35 bits away
  descriptors[9] = descriptors[5];
  descriptors[9][2] ^= (1ULL << 36) - 1;  // 36 bits away
  const std::vector<bool> keep = self_similarity_keep(descriptors, 35);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    std::size_t nearest = 257;
    for (std::size_t j = 0; j < descriptors.size(); ++j) {
      if (i != j) nearest = std::min(nearest, bit_by_bit(descriptors[i], descriptors[j]));
    }
    EXPECT_EQ(keep[i], nearest > 35) << i;
  }
  EXPECT_FALSE(keep[3]);
  EXPECT_FALSE(keep[7]);
  EXPECT_TRUE(keep[5]);
  EXPECT_TRUE(keep[9]);
}

TEST(Pruning, NoneAndASingleDescriptorHaveNothingToResemble) {
  EXPECT_TRUE(self_similarity_keep({}, 35).empty());
  EXPECT_TRUE(self_similarity_keep(random_descriptors(1, 4), 255)[0]);
}

TEST(Pruning, EqualDescriptorsAllGo) {
  const std::vector<Descriptor> equal(5, random_descriptors(1, 5)[0]);
  EXPECT_EQ(self_similarity_keep(equal, 0), std::vector<bool>(5, false));
}

}  // namespace
}  // namespace groundloop
