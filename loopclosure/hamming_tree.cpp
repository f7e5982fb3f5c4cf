#include "loopclosure/hamming_tree.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "loopclosure/hamming.hpp"

namespace groundloop {

HammingTree::HammingTree(std::size_t leaf_size) : leaf_size_(std::max<std::size_t>(1, leaf_size)) {
  nodes_.emplace_back();
  leaves_.emplace_back();
}

std::uint32_t HammingTree::find_leaf_node(const Descriptor& descriptor) const {
  std::uint32_t node = 0;
  while (nodes_[node].bit >= 0) {
    node = descriptor_bit(descriptor, nodes_[node].bit) ? nodes_[node].one : nodes_[node].zero;
  }
  return node;
}

void HammingTree::insert(const Descriptor& descriptor, std::uint32_t id) {
  const std::uint32_t node = find_leaf_node(descriptor);
  Leaf& leaf = leaves_[nodes_[node].leaf];
  leaf.descriptors.push_back(descriptor);
  leaf.ids.push_back(id);
  ++size_;
  if (leaf.ids.size() > std::max(leaf_size_, leaf.retry_size)) split(node);
}

void HammingTree::split(std::uint32_t node) {
  const std::uint32_t leaf_index = nodes_[node].leaf;
  Leaf& leaf = leaves_[leaf_index];
  const std::size_t n = leaf.ids.size();
  std::array<std::size_t, 256> ones{};
  for (const Descriptor& d : leaf.descriptors) {
    for (int b = 0; b < 256; ++b) ones[static_cast<std::size_t>(b)] += descriptor_bit(d, b) ? 1 : 0;
  }
  // Mean nearest one half: |2 ones - n| least; the first such bit.
  int best = -1;
  std::size_t best_imbalance = n;  // all equal in a bit: it splits nothing
  for (int b = 0; b < 256; ++b) {
    const std::size_t twice = 2 * ones[static_cast<std::size_t>(b)];
    const std::size_t imbalance = twice > n ? twice - n : n - twice;
    if (imbalance < best_imbalance) best = b, best_imbalance = imbalance;
  }
  if (best < 0) {
    leaf.retry_size = 2 * n;
    return;
  }
  Leaf zero, one;
  for (std::size_t i = 0; i < n; ++i) {
    Leaf& side = descriptor_bit(leaf.descriptors[i], best) ? one : zero;
    side.descriptors.push_back(leaf.descriptors[i]);
    side.ids.push_back(leaf.ids[i]);
  }
  const auto zero_node = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node] = {best, zero_node, zero_node + 1, 0};
  nodes_.push_back({-1, 0, 0, leaf_index});
  nodes_.push_back({-1, 0, 0, static_cast<std::uint32_t>(leaves_.size())});
  const bool zero_large = zero.ids.size() > leaf_size_, one_large = one.ids.size() > leaf_size_;
  leaves_[leaf_index] = std::move(zero);
  leaves_.push_back(std::move(one));
  // A leaf of equal descriptors outgrew its size before one came that differs.
  if (zero_large) split(zero_node);
  if (one_large) split(zero_node + 1);
}

void HammingTree::search(const Descriptor& query, int max_distance,
                         std::vector<Match>& matches) const {
  matches.clear();
  const Leaf& leaf = leaves_[nodes_[find_leaf_node(query)].leaf];
  std::array<std::uint16_t, 256> distances;
  for (std::size_t begin = 0; begin < leaf.ids.size(); begin += distances.size()) {
    const std::size_t count = std::min(distances.size(), leaf.ids.size() - begin);
    hamming_distances(query, leaf.descriptors.data() + begin, count, distances.data());
    for (std::size_t i = 0; i < count; ++i) {
      if (distances[i] <= max_distance) matches.push_back({leaf.ids[begin + i], distances[i]});
    }
  }
}

std::size_t HammingTree::leaves() const { return leaves_.size(); }

std::size_t HammingTree::depth() const {
  std::size_t deepest = 0;
  std::vector<std::pair<std::uint32_t, std::size_t>> open{{0, 0}};
  while (!open.empty()) {
    const auto [node, level] = open.back();
    open.pop_back();
    deepest = std::max(deepest, level);
    if (nodes_[node].bit < 0) continue;
    open.emplace_back(nodes_[node].zero, level + 1);
    open.emplace_back(nodes_[node].one, level + 1);
  }
  return deepest;
}

std::size_t HammingTree::largest_leaf() const {
  std::size_t largest = 0;
  for (const Leaf& leaf : leaves_) largest = std::max(largest, leaf.ids.size());
  return largest;
}

}  // namespace groundloop
