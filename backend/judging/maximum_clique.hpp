// The largest set of vertices of a graph that are all joined to each other, by branch and bound
// with a greedy colouring as the bound (Tomita and Kameda, 2007). Exact up to a limit on the
// search; deterministic.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace groundloop {

/// An undirected graph as rows of bits.
class Adjacency {
 public:
  explicit Adjacency(std::size_t n) : n_(n), words_((n + 63) / 64), bits_(n * words_, 0) {}
  [[nodiscard]] std::size_t size() const { return n_; }
  [[nodiscard]] std::size_t words() const { return words_; }
  [[nodiscard]] const std::uint64_t* row(std::size_t i) const { return &bits_[i * words_]; }
  [[nodiscard]] bool joined(std::size_t i, std::size_t j) const {
    return (row(i)[j / 64] >> (j % 64)) & 1U;
  }
  void join(std::size_t i, std::size_t j) {
    bits_[i * words_ + j / 64] |= std::uint64_t{1} << (j % 64);
    bits_[j * words_ + i / 64] |= std::uint64_t{1} << (i % 64);
  }

 private:
  std::size_t n_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

struct Clique {
  std::vector<int> members;  ///< rising
  bool proven = true;        ///< false where the search ended at its limit: maybe not the largest
};

/// Largest clique among the vertices with `allowed[i]`; at most `limit` nodes of search.
[[nodiscard]] Clique maximum_clique(const Adjacency& graph, const std::vector<char>& allowed,
                                    std::size_t limit = 200000);

}  // namespace groundloop
