// Disjoint sets of the numbers below n, with path halving; a set is represented by its least
// member, so that numbering does not depend on the order of joining.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace groundloop {

class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  [[nodiscard]] int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// False where the two were joined before.
  bool join(int i, int j) {
    const int a = root(i);
    const int b = root(j);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }
  /// The set of each number, counted from 0 by first member.
  [[nodiscard]] std::vector<int> numbered() {
    std::vector<int> set(parent_.size());
    int count = 0;
    for (int i = 0; i < static_cast<int>(set.size()); ++i) {
      const int first = root(i);
      set[i] = first == i ? count++ : set[first];
    }
    return set;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace groundloop
