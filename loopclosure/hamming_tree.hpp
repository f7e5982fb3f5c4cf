// A binary search tree over descriptor bits (Schlegel and Grisetti, RA-L 2018; Sec. 3.5 of the
// paper). A descriptor follows its bits to a leaf and is compared with what lies there, so a search
// may miss a neighbour that differs in a bit of the path; several trees or an exhaustive search
// miss fewer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "loopclosure/loop_closure.hpp"

namespace groundloop {

class HammingTree {
 public:
  /// A leaf that holds more than `leaf_size` descriptors is split, on the bit not yet used on its
  /// path whose mean is nearest one half; leaves whose descriptors are all equal are not.
  explicit HammingTree(std::size_t leaf_size = 100);

  /// Adds a descriptor under a number of the caller's choice.
  void insert(const Descriptor& descriptor, std::uint32_t id);

  struct Match {
    std::uint32_t id = 0;
    int distance = 0;
  };
  /// The descriptors within `max_distance` in the leaf that `query` reaches, in the order they were
  /// inserted into it; replaces the contents of `matches`.
  void search(const Descriptor& query, int max_distance, std::vector<Match>& matches) const;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t leaves() const;
  [[nodiscard]] std::size_t depth() const;
  /// Size of the greatest leaf.
  [[nodiscard]] std::size_t largest_leaf() const;

 private:
  struct Leaf {
    std::vector<Descriptor> descriptors;
    std::vector<std::uint32_t> ids;
    std::size_t retry_size = 0;  ///< no split is tried below
  };
  struct Node {
    std::int32_t bit = -1;  ///< -1: a leaf
    std::uint32_t zero = 0, one = 0;
    std::uint32_t leaf = 0;
  };
  [[nodiscard]] std::uint32_t find_leaf_node(const Descriptor& descriptor) const;
  void split(std::uint32_t node);

  std::size_t leaf_size_;
  std::size_t size_ = 0;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
};

}  // namespace groundloop
