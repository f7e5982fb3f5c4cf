#include "backend/graph/normal_equations.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// Factors are linearised this many at a time, so that what they give fits into a cache.
constexpr std::size_t kChunk = 2048;
constexpr std::size_t kBlock = 128;

// Variables of a factor without linearising it; -1 where it has fewer.
using Variables = std::array<int, 3>;

Variables variables_of(const PoseGraph& graph, const GraphEdge& edge) {
  return {edge.from, edge.to, edge.bend < 0 ? -1 : bend_variable(graph, edge.bend)};
}
Variables variables_of(const PoseGraph& graph, const VerticalFactor& vertical) {
  return {vertical.vertex, up_variable(graph, vertical.frame), -1};
}
Variables variables_of(const PoseGraph&, const PosePrior& prior) { return {prior.vertex, -1, -1}; }
Variables variables_of(const PoseGraph& graph, const BendPrior& prior) {
  return {bend_variable(graph, prior.bend), -1, -1};
}

// What one factor adds to the normal equations.
struct Terms {
  bool counts = false;
  double cost = 0.0;
  std::array<int, 3> block{-1, -1, -1};
  std::array<Vector6d, 3> gradient;
  std::array<Matrix6d, 3> diagonal;
  std::array<Matrix6d, 3> pair;  // (0,1), (0,2), (1,2): rows of the first, columns of the second
};

constexpr std::array<std::pair<int, int>, 3> kPairs{{{0, 1}, {0, 2}, {1, 2}}};

Terms terms_of(const Linearised& l, const std::vector<int>& block_of) {
  Terms t;
  t.counts = true;
  const Vector6d weighted = l.information * l.residual;
  t.cost = 0.5 * l.residual.dot(weighted);
  std::array<Matrix6d, 3> metric;  // information times J
  for (int i = 0; i < l.blocks; ++i) {
    t.block[i] = block_of[l.block[i].variable];
    if (t.block[i] < 0) continue;
    metric[i].noalias() = l.information * l.block[i].J;
    t.diagonal[i].noalias() = l.block[i].J.transpose() * metric[i];
    t.gradient[i].noalias() = l.block[i].J.transpose() * weighted;
  }
  for (std::size_t p = 0; p < kPairs.size(); ++p) {
    const auto [i, j] = kPairs[p];
    if (t.block[i] >= 0 && t.block[j] >= 0)
      t.pair[p].noalias() = l.block[i].J.transpose() * metric[j];
  }
  return t;
}

}  // namespace

struct NormalEquations::Layout {
  std::vector<int> block_of, first_row, sizes;
  std::vector<std::pair<int, int>> pairs;

  Layout(const PoseGraph& graph, const std::vector<char>& held) {
    const std::size_t variables = graph.vertices.size() + graph.ups.size() + graph.bends.size();
    // Poses are unknowns even where nothing is said of them; ups and bends only with a factor.
    std::vector<char> free(variables, 0);
    for (std::size_t i = 0; i < held.size(); ++i) free[i] = !held[i];
    for (const VerticalFactor& v : graph.verticals) free[up_variable(graph, v.frame)] = 1;
    for (const BendPrior& p : graph.bend_priors) free[bend_variable(graph, p.bend)] = 1;
    block_of.assign(variables, -1);
    first_row.push_back(0);
    for (std::size_t v = 0; v < variables; ++v) {
      if (!free[v]) continue;
      block_of[v] = static_cast<int>(sizes.size());
      sizes.push_back(size_of_variable(graph, static_cast<int>(v)));
      first_row.push_back(first_row.back() + sizes.back());
    }
    for_each_kind(graph, [&](const auto& factors) {
      for (const auto& factor : factors) {
        if (counts(factor)) add(variables_of(graph, factor));
      }
    });
  }

  void add(const Variables& v) {
    for (const auto& [i, j] : kPairs) {
      if (v[i] < 0 || v[j] < 0 || block_of[v[i]] < 0 || block_of[v[j]] < 0) continue;
      pairs.emplace_back(block_of[v[i]], block_of[v[j]]);
    }
  }
};

NormalEquations::NormalEquations(const PoseGraph& graph, const std::vector<char>& held)
    : NormalEquations(Layout(graph, held)) {}

NormalEquations::NormalEquations(Layout layout)
    : block_of_(std::move(layout.block_of)),
      first_row_(std::move(layout.first_row)),
      sizes_(layout.sizes),
      matrix_(std::move(layout.sizes), layout.pairs) {}

double NormalEquations::assemble(const PoseGraph& graph) {
  matrix_.set_zero();
  gradient_ = Eigen::VectorXd::Zero(first_row_.back());
  double cost = 0.0;
  std::size_t pair = 0;
  std::vector<Terms> terms;
  const auto add = [&](const Terms& t) {
    cost += t.cost;
    for (int i = 0; i < 3; ++i) {
      const int b = t.block[i];
      if (b < 0) continue;
      gradient_.segment(first_row_[b], sizes_[b]) += t.gradient[i].head(sizes_[b]);
      matrix_.add_diagonal(b, t.diagonal[i].topLeftCorner(sizes_[b], sizes_[b]));
    }
    for (std::size_t p = 0; p < kPairs.size(); ++p) {
      const int i = t.block[kPairs[p].first];
      const int j = t.block[kPairs[p].second];
      if (i >= 0 && j >= 0) matrix_.add_pair(pair++, t.pair[p].topLeftCorner(sizes_[i], sizes_[j]));
    }
  };
  for_each_kind(graph, [&](const auto& factors) {
    for (std::size_t begin = 0; begin < factors.size(); begin += kChunk) {
      const std::size_t count = std::min(kChunk, factors.size() - begin);
      terms.resize(count);
      parallel_for(count, kBlock, [&](std::size_t k) {
        const auto& factor = factors[begin + k];
        terms[k].counts = false;
        if (counts(factor)) terms[k] = terms_of(linearise(graph, factor), block_of_);
      });
      for (std::size_t k = 0; k < count; ++k) {
        if (terms[k].counts) add(terms[k]);
      }
    }
  });
  return cost;
}

}  // namespace groundloop
