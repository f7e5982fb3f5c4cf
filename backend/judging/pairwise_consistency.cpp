#include "backend/judging/pairwise_consistency.hpp"

#include <algorithm>

#include "backend/judging/maximum_clique.hpp"
#include "backend/judging/robust.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {

double pairwise_distance(const PairwiseClosure& a, const PairwiseClosure& b,
                         const ChainFunction& odometry_from, const ChainFunction& odometry_to) {
  return squared_mahalanobis(a.T_from_to * odometry_to(a.to, b.to) * inverse(b.T_from_to) *
                             odometry_from(b.from, a.from));
}

ConsistentSets consistent_sets(const std::vector<PairwiseClosure>& closures,
                               const ChainFunction& odometry_from, const ChainFunction& odometry_to,
                               const ConsistencyOptions& options) {
  const std::size_t n = closures.size();
  const double bound = chi_square_quantile_6(options.probability);
  // Rows of their own bytes: threads never write to one word together.
  std::vector<std::vector<char>> agrees(n);
  parallel_for(n, 4, [&](std::size_t i) {
    agrees[i].resize(i);
    for (std::size_t j = 0; j < i; ++j) {
      const double distance =
          pairwise_distance(closures[i], closures[j], odometry_from, odometry_to);
      agrees[i][j] = distance <= bound;
    }
  });
  Adjacency graph(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (agrees[i][j]) graph.join(i, j);
    }
  }
  ConsistentSets result;
  std::vector<char> left(n, 1);
  for (std::size_t remaining = n; remaining > 0;) {
    Clique clique = maximum_clique(graph, left);
    if (result.sets.empty()) result.proven = clique.proven;
    for (const int i : clique.members) left[i] = 0;
    remaining -= clique.members.size();
    result.sets.push_back(std::move(clique.members));
  }
  return result;
}

}  // namespace groundloop
