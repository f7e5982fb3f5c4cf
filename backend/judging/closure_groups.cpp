#include "backend/judging/closure_groups.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "frontend/core/union_find.hpp"

namespace groundloop {
namespace {

// Of a verified closure: one in twenty is false.
constexpr double kLogOdds = 3.0;
// What each further member of a group adds to its log-odds: false groups tend to be small.
constexpr double kLogOddsOfNeighbour = 0.5;

struct Link {
  double log_density;
  int a, b;  // places among the closures
};

// The loop a, odometry, b backwards, odometry.
RelativePose loop_of(const GraphEdge& a, const GraphEdge& b, const OdometryTree& odometry) {
  const auto closure = [](const GraphEdge& edge) {
    return RelativePose{edge.T_from_to, bounded_information(edge.information).inverse()};
  };
  return closure(a) * odometry.between(a.to, b.to) * inverse(closure(b)) *
         odometry.between(b.from, a.from);
}

}  // namespace

double log_density(const RelativePose& loop) {
  const Vector6d r = log_se3(loop.T_from_to);
  const Eigen::LDLT<Matrix6d> factor(loop.covariance);
  return -0.5 * r.dot(factor.solve(r)) - 0.5 * factor.vectorD().array().log().sum() -
         3.0 * std::log(2.0 * std::numbers::pi);
}

double log_prior(const ClosureGroups& groups, bool called_true) {
  double sum = 0.0;
  for (const std::vector<std::size_t>& members : groups.groups) {
    const double odds = kLogOdds + kLogOddsOfNeighbour * static_cast<double>(members.size() - 1);
    sum -= std::log1p(std::exp(called_true ? -odds : odds));
  }
  return sum;
}

ClosureGroups group_closures(const PoseGraph& graph, const OdometryTree& odometry,
                             const std::vector<std::size_t>& closures, double distance,
                             double bound) {
  const std::size_t n = closures.size();
  std::vector<Link> links;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const GraphEdge& a = graph.edges[closures[i]];
      const GraphEdge& b = graph.edges[closures[j]];
      const auto far = [&](int p, int q) {
        return (odometry.pose(p).translation - odometry.pose(q).translation).norm() > distance;
      };
      if (far(a.from, b.from) || far(a.to, b.to)) continue;
      const RelativePose loop = loop_of(a, b, odometry);
      if (squared_mahalanobis(loop) <= bound)
        links.push_back({log_density(loop), static_cast<int>(i), static_cast<int>(j)});
    }
  }
  // The tightest links span each group.
  std::stable_sort(links.begin(), links.end(),
                   [](const Link& x, const Link& y) { return x.log_density > y.log_density; });
  UnionFind sets(n);
  std::vector<double> inner(n, 0.0);
  for (const Link& link : links) {
    const auto [low, high] = std::minmax({sets.root(link.a), sets.root(link.b)});
    if (!sets.join(low, high)) continue;
    inner[low] += inner[high] + link.log_density;
  }
  ClosureGroups result;
  std::vector<std::size_t> group_of(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto root = static_cast<std::size_t>(sets.root(static_cast<int>(i)));
    if (root == i) {
      group_of[i] = result.groups.size();
      result.groups.emplace_back();
      result.inner_log_density.push_back(inner[i]);
    }
    result.groups[group_of[root]].push_back(closures[i]);
  }
  return result;
}

}  // namespace groundloop
