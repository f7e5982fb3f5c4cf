#include "loopclosure/hamming_forest.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "loopclosure/hamming.hpp"

namespace groundloop {
namespace {

constexpr std::uint16_t kFar = 0x7fff;  // above any distance

}  // namespace

HammingForest::HammingForest(std::size_t trees, std::size_t leaf_size, double max_imbalance)
    : leaf_size_(std::max<std::size_t>(1, leaf_size)),
      max_imbalance_(max_imbalance),
      bit_stride_(std::clamp<std::size_t>(trees, 1, 256)),
      trees_(bit_stride_) {}

void HammingForest::keep_trees(std::size_t trees) {
  if (trees < trees_.size()) trees_.resize(std::max<std::size_t>(1, trees));
}

std::uint32_t HammingForest::leaf_node(const Tree& tree, const Descriptor& descriptor) {
  std::uint32_t node = 0;
  while (tree.nodes[node].bit >= 0) {
    node = tree.nodes[node].zero + (descriptor_bit(descriptor, tree.nodes[node].bit) ? 1U : 0U);
  }
  return node;
}

void HammingForest::insert(std::span<const Descriptor> descriptors) {
  const auto first = static_cast<std::uint32_t>(descriptors_.size());
  descriptors_.insert(descriptors_.end(), descriptors.begin(), descriptors.end());
  std::vector<std::uint32_t> touched;
  for (std::size_t t = 0; t < trees_.size(); ++t) {
    touched.clear();
    for (std::uint32_t i = 0; i < descriptors.size(); ++i) {
      const std::uint32_t node = leaf_node(trees_[t], descriptors[i]);
      Leaf& leaf = trees_[t].leaves[trees_[t].nodes[node].zero];
      leaf.ids.push_back(first + i);
      // Named once, when it has just grown too large.
      if (leaf.ids.size() == std::max(leaf_size_, leaf.unsplit_size) + 1) touched.push_back(node);
    }
    for (const std::uint32_t node : touched) split(t, node);
  }
}

void HammingForest::split(std::size_t tree_index, std::uint32_t node) {
  Tree& tree = trees_[tree_index];
  const std::uint32_t leaf_index = tree.nodes[node].zero;
  const std::vector<std::uint32_t> ids = std::move(tree.leaves[leaf_index].ids);
  const std::size_t n = ids.size();
  std::array<std::size_t, 256> ones{};
  for (const std::uint32_t id : ids) {
    for (std::size_t b = tree_index; b < 256; b += bit_stride_) {
      ones[b] += descriptor_bit(descriptors_[id], static_cast<int>(b)) ? 1U : 0U;
    }
  }
  // Mean nearest one half: |2 ones - n| least; the first such bit. A bit already used on the path
  // is the same in all of them and splits nothing.
  std::size_t best = 256, best_imbalance = n;
  for (std::size_t b = tree_index; b < 256; b += bit_stride_) {
    const std::size_t twice = 2 * ones[b];
    const std::size_t imbalance = twice > n ? twice - n : n - twice;
    if (imbalance < best_imbalance) best = b, best_imbalance = imbalance;
  }
  if (best == 256) {
    tree.leaves[leaf_index] = {ids, 2 * n};
    return;
  }
  // |mean - 1/2| is half the imbalance over n. More descriptors may balance it: tried again.
  if (static_cast<double>(best_imbalance) > 2 * max_imbalance_ * static_cast<double>(n)) {
    tree.leaves[leaf_index] = {ids, n};
    return;
  }
  Leaf zero, one;
  for (const std::uint32_t id : ids) {
    (descriptor_bit(descriptors_[id], static_cast<int>(best)) ? one : zero).ids.push_back(id);
  }
  const auto child = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes[node] = {static_cast<std::int32_t>(best), child};
  tree.nodes.push_back({-1, leaf_index});
  tree.nodes.push_back({-1, static_cast<std::uint32_t>(tree.leaves.size())});
  const bool zero_large = zero.ids.size() > leaf_size_, one_large = one.ids.size() > leaf_size_;
  tree.leaves[leaf_index] = std::move(zero);
  tree.leaves.push_back(std::move(one));
  // A leaf of equal descriptors outgrew its size before one came that differs.
  if (zero_large) split(tree_index, child);
  if (one_large) split(tree_index, child + 1);
}

void HammingForest::search(const Descriptor& query, int max_distance,
                           std::vector<Match>& matches) const {
  matches.clear();
  // All trees are descended first, so that the leaves come nearer while others are read.
  std::array<const std::vector<std::uint32_t>*, 256> leaves;
  for (std::size_t t = 0; t < trees_.size(); ++t) {
    leaves[t] = &trees_[t].leaves[trees_[t].nodes[leaf_node(trees_[t], query)].zero].ids;
    __builtin_prefetch(leaves[t]->data());
  }
  constexpr std::size_t kChunk = 128, kGroup = 16;
  std::array<std::uint16_t, kChunk> distances;
  for (std::size_t t = 0; t < trees_.size(); ++t) {
    const std::vector<std::uint32_t>& ids = *leaves[t];
    for (std::size_t begin = 0; begin < ids.size(); begin += kChunk) {
      const std::size_t count = std::min(kChunk, ids.size() - begin);
      hamming_distances_at(query, descriptors_.data(), ids.data() + begin, count, distances.data());
      std::fill(distances.begin() + static_cast<std::ptrdiff_t>(count), distances.end(), kFar);
      for (std::size_t group = 0; group < count; group += kGroup) {
        // Matches are rare: most groups have none.
        std::uint16_t least = kFar;
        for (std::size_t i = group; i < group + kGroup; ++i) least = std::min(least, distances[i]);
        if (least > max_distance) continue;
        for (std::size_t i = group; i < std::min(group + kGroup, count); ++i) {
          if (distances[i] <= max_distance) matches.push_back({ids[begin + i], distances[i]});
        }
      }
    }
  }
  if (trees_.size() == 1) return;  // ids are in order and appear once
  std::sort(matches.begin(), matches.end(),
            [](const Match& a, const Match& b) { return a.id < b.id; });
  matches.erase(std::unique(matches.begin(), matches.end(),
                            [](const Match& a, const Match& b) { return a.id == b.id; }),
                matches.end());
}

std::size_t HammingForest::depth() const {
  const Tree& tree = trees_.front();
  std::size_t deepest = 0;
  std::vector<std::pair<std::uint32_t, std::size_t>> open{{0, 0}};
  while (!open.empty()) {
    const auto [node, level] = open.back();
    open.pop_back();
    deepest = std::max(deepest, level);
    if (tree.nodes[node].bit < 0) continue;
    open.emplace_back(tree.nodes[node].zero, level + 1);
    open.emplace_back(tree.nodes[node].zero + 1, level + 1);
  }
  return deepest;
}

std::size_t HammingForest::largest_leaf() const {
  std::size_t largest = 0;
  for (const Tree& tree : trees_) {
    for (const Leaf& leaf : tree.leaves) largest = std::max(largest, leaf.ids.size());
  }
  return largest;
}

}  // namespace groundloop
