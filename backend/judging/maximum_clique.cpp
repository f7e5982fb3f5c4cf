#include "backend/judging/maximum_clique.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace groundloop {
namespace {

using Bits = std::vector<std::uint64_t>;

class Search {
 public:
  Search(const Adjacency& graph, const std::vector<char>& allowed, std::size_t limit)
      : graph_(relabelled(graph, allowed)), limit_(limit) {}

  Clique run() {
    Bits all(graph_.words(), 0);
    for (std::size_t i = 0; i < graph_.size(); ++i) all[i / 64] |= std::uint64_t{1} << (i % 64);
    expand(all);
    Clique result;
    result.proven = nodes_ < limit_;
    for (const int v : best_) result.members.push_back(label_[v]);
    std::sort(result.members.begin(), result.members.end());
    return result;
  }

 private:
  // Vertices by falling degree: the colouring is tighter so, and the first descent finds a good
  // clique.
  Adjacency relabelled(const Adjacency& graph, const std::vector<char>& allowed) {
    std::vector<std::size_t> degree(graph.size(), 0);
    for (std::size_t i = 0; i < graph.size(); ++i) {
      if (!allowed[i]) continue;
      label_.push_back(static_cast<int>(i));
      for (std::size_t j = 0; j < graph.size(); ++j) degree[i] += allowed[j] && graph.joined(i, j);
    }
    std::stable_sort(label_.begin(), label_.end(),
                     [&](int a, int b) { return degree[a] > degree[b]; });
    Adjacency result(label_.size());
    for (std::size_t i = 0; i < label_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (graph.joined(label_[i], label_[j])) result.join(i, j);
      }
    }
    return result;
  }

  // Colours `candidates` greedily; `order` lists them by rising colour, which bounds the clique
  // within each prefix.
  void colour(Bits uncoloured, std::vector<int>& order, std::vector<int>& colours) const {
    for (int colour = 1;; ++colour) {
      Bits free = uncoloured;
      bool any = false;
      for (std::size_t w = 0; w < free.size(); ++w) {
        while (free[w] != 0) {
          const int v = static_cast<int>(64 * w) + std::countr_zero(free[w]);
          any = true;
          uncoloured[w] &= ~(std::uint64_t{1} << (v % 64));
          free[w] &= ~(std::uint64_t{1} << (v % 64));
          const std::uint64_t* neighbours = graph_.row(v);
          for (std::size_t u = w; u < free.size(); ++u) free[u] &= ~neighbours[u];
          order.push_back(v);
          colours.push_back(colour);
        }
      }
      if (!any) return;
    }
  }

  void expand(Bits candidates) {
    std::vector<int> order;
    std::vector<int> colours;
    colour(candidates, order, colours);
    for (std::size_t i = order.size(); i-- > 0;) {
      if (current_.size() + static_cast<std::size_t>(colours[i]) <= best_.size()) return;
      if (++nodes_ >= limit_) return;
      const int v = order[i];
      current_.push_back(v);
      Bits next(candidates);
      bool any = false;
      for (std::size_t w = 0; w < next.size(); ++w) {
        next[w] &= graph_.row(v)[w];
        any = any || next[w] != 0;
      }
      if (any) {
        expand(std::move(next));
      } else if (current_.size() > best_.size()) {
        best_ = current_;
      }
      current_.pop_back();
      candidates[v / 64] &= ~(std::uint64_t{1} << (v % 64));
    }
  }

  std::vector<int> label_;  // before graph_, which fills it
  Adjacency graph_;
  std::size_t limit_;
  std::size_t nodes_ = 0;
  std::vector<int> current_;
  std::vector<int> best_;
};

}  // namespace

Clique maximum_clique(const Adjacency& graph, const std::vector<char>& allowed, std::size_t limit) {
  return Search(graph, allowed, limit).run();
}

}  // namespace groundloop
