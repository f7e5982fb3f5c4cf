// Binary search trees over descriptor bits (Schlegel and Grisetti, RA-L 2018; Sec. 3.5 of the
// paper). A descriptor follows its bits to a leaf and is compared with what lies there, so that one
// tree misses a neighbour that differs in a bit of the path. The paper's database is one tree; here
// several trees, each splitting on bits of its own, miss one only where all of them do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "loopclosure/loop_closure.hpp"

namespace groundloop {

class HammingForest {
 public:
  /// Tree t of `trees` splits on bits t, t + trees, t + 2 trees, ...; one tree uses all bits. A
  /// leaf that holds more than `leaf_size` descriptors is split, on the bit whose mean is nearest
  /// one half; where all its descriptors agree in all bits of the tree it is not, nor where no mean
  /// is within `max_imbalance` of one half.
  explicit HammingForest(std::size_t trees = 1, std::size_t leaf_size = 100,
                         double max_imbalance = 0.5);

  /// Adds descriptors, those of a map together: leaves are split once all of them are in their
  /// leaves. The number of the first is size() before.
  void insert(std::span<const Descriptor> descriptors);

  struct Match {
    std::uint32_t id = 0;
    int distance = 0;  ///< bits
  };
  /// The descriptors within `max_distance` in the leaves that `query` reaches, each once, in order
  /// of their numbers; replaces the contents of `matches`.
  void search(const Descriptor& query, int max_distance, std::vector<Match>& matches) const;

  /// Gives up all trees but the first `trees` (at least one), with their memory.
  void keep_trees(std::size_t trees);
  [[nodiscard]] std::size_t trees() const { return trees_.size(); }

  [[nodiscard]] std::size_t size() const { return descriptors_.size(); }
  /// Of the first tree.
  [[nodiscard]] std::size_t leaves() const { return trees_.front().leaves.size(); }
  [[nodiscard]] std::size_t depth() const;
  /// Size of the greatest leaf of any tree.
  [[nodiscard]] std::size_t largest_leaf() const;

 private:
  struct Leaf {
    std::vector<std::uint32_t> ids;
    std::size_t unsplit_size = 0;  ///< no split is tried up to here
  };
  struct Node {
    std::int32_t bit = -1;   ///< -1: a leaf
    std::uint32_t zero = 0;  ///< the node of bit 0, that of bit 1 follows it; of a leaf: its index
  };
  struct Tree {
    std::vector<Node> nodes{1};
    std::vector<Leaf> leaves{1};
  };
  [[nodiscard]] static std::uint32_t leaf_node(const Tree& tree, const Descriptor& descriptor);
  void split(std::size_t tree, std::uint32_t node);

  std::size_t leaf_size_;
  double max_imbalance_;
  std::size_t bit_stride_;  ///< trees at first
  std::vector<Descriptor> descriptors_;
  std::vector<Tree> trees_;
};

}  // namespace groundloop
