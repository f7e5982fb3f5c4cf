#include "backend/judging/closure_groups.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Cholesky>

namespace groundloop {
namespace {

// Of a verified closure: one in twenty is false.
constexpr double kLogOdds = 3.0;
// What each further member of a group adds to its log-odds: false groups tend to be small.
constexpr double kLogOddsOfNeighbour = 0.5;

struct Link {
  double log_density;
  std::size_t a, b;  // places among the closures
};

// The loop a, odometry, b backwards, odometry.
RelativePose loop_of(const PoseGraph& graph, const RelativePose& from_b_from_a,
                     const RelativePose& to_a_to_b, std::size_t a, std::size_t b) {
  const auto closure = [&](std::size_t k) {
    return RelativePose{graph.edges[k].T_from_to,
                        bounded_information(graph.edges[k].information).inverse()};
  };
  return closure(a) * to_a_to_b * inverse(closure(b)) * from_b_from_a;
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

Matrix6d bounded_information(const Matrix6d& information) {
  // A direction that the surfaces leave free is known to 100 m and 1 rad.
  Matrix6d bounded = information;
  bounded.diagonal().head<3>().array() += 1e-4;
  bounded.diagonal().tail<3>().array() += 1.0;
  return bounded;
}

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

ClosureGroups group_closures(const PoseGraph& graph, const std::vector<EdgeEnds>& ends,
                             const OdometryTree& odometry, const std::vector<std::size_t>& closures,
                             double distance, double bound) {
  const std::size_t n = closures.size();
  std::vector<Link> links;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const std::size_t a = closures[i];
      const std::size_t b = closures[j];
      const auto far = [&](int p, int q) {
        return (odometry.pose(p).translation - odometry.pose(q).translation).norm() > distance;
      };
      if (far(ends[a].from, ends[b].from) || far(ends[a].to, ends[b].to)) continue;
      const RelativePose loop = loop_of(graph, odometry.between(ends[b].from, ends[a].from),
                                        odometry.between(ends[a].to, ends[b].to), a, b);
      if (squared_mahalanobis(loop) <= bound) links.push_back({log_density(loop), i, j});
    }
  }
  // The tightest links span each group.
  std::stable_sort(links.begin(), links.end(),
                   [](const Link& x, const Link& y) { return x.log_density > y.log_density; });
  std::vector<std::size_t> parent(n);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  std::vector<double> inner(n, 0.0);
  for (const Link& link : links) {
    std::size_t low = root_of(parent, link.a);
    std::size_t high = root_of(parent, link.b);
    if (low == high) continue;
    if (high < low) std::swap(low, high);
    parent[high] = low;
    inner[low] += inner[high] + link.log_density;
  }
  ClosureGroups result;
  std::vector<std::size_t> group_of(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t root = root_of(parent, i);
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
