#include "loopclosure/consensus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>

namespace groundloop {
namespace {

constexpr int kRotationBins = 180;
constexpr std::size_t kHypotheses = 5;
constexpr int kRefinements = 10;

struct Matched {
  Eigen::Vector2d query, reference;
  double turn;  // orientation of the query keypoint less that of the reference keypoint
};

std::vector<Matched> positions(const MapDescription& query, const MapDescription& reference,
                               std::span<const KeypointMatch> matches) {
  std::vector<Matched> result;
  result.reserve(matches.size());
  for (const KeypointMatch& m : matches) {
    const double turn = query.orientations.empty() || reference.orientations.empty()
                            ? 0.0
                            : static_cast<double>(query.orientations[m.query] -
                                                  reference.orientations[m.reference]);
    result.push_back({query.keypoints[m.query].cast<double>(),
                      reference.keypoints[m.reference].cast<double>(), wrap_angle(turn)});
  }
  return result;
}

// Indices of matches within `radius` of the alignment, each keypoint once: the nearer descriptor
// first, then the nearer point.
std::vector<std::size_t> inliers_of(const PlanarTransform& T, const std::vector<Matched>& points,
                                    std::span<const KeypointMatch> matches, double radius) {
  struct Near {
    int distance;
    double error;
    std::size_t index;
  };
  std::vector<Near> near;
  const Eigen::Matrix2d R = rotation_matrix(T);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = (R * points[i].reference + T.translation - points[i].query).squaredNorm();
    if (error <= radius * radius) near.push_back({matches[i].distance, error, i});
  }
  std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
    return std::tie(a.distance, a.error, a.index) < std::tie(b.distance, b.error, b.index);
  });
  std::vector<std::size_t> chosen;
  for (const Near& n : near) {
    const bool taken = std::any_of(chosen.begin(), chosen.end(), [&](std::size_t c) {
      return matches[c].query == matches[n.index].query ||
             matches[c].reference == matches[n.index].reference;
    });
    if (!taken) chosen.push_back(n.index);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

PlanarTransform fit(const std::vector<Matched>& points, const std::vector<std::size_t>& indices) {
  std::vector<Eigen::Vector2d> a, b;
  for (const std::size_t i : indices) {
    a.push_back(points[i].query);
    b.push_back(points[i].reference);
  }
  return fit_planar_transform(a, b);
}

struct Fitted {
  PlanarTransform T;
  std::vector<std::size_t> inliers;
};

// Fits to the inliers of `start` and counts again while that finds more.
Fitted refine(const PlanarTransform& start, double start_radius, const std::vector<Matched>& points,
              std::span<const KeypointMatch> matches, double radius) {
  Fitted best{start, inliers_of(start, points, matches, radius)};
  std::vector<std::size_t> support = inliers_of(start, points, matches, start_radius);
  for (int i = 0; i < kRefinements && support.size() >= 2; ++i) {
    const PlanarTransform T = fit(points, support);
    std::vector<std::size_t> inliers = inliers_of(T, points, matches, radius);
    const bool better = inliers.size() > best.inliers.size() || i == 0;
    if (!better) break;
    if (inliers.size() >= best.inliers.size()) best = {T, inliers};
    support = std::move(inliers);
  }
  return best;
}

// An alignment that carries one match exactly, with the number of others that may agree.
struct Hypothesis {
  std::size_t anchor = 0;
  double angle = 0.0;
  int votes = 0;
};

// If an alignment has `anchor` and others as inliers of radius r, then the one that carries the
// anchor exactly with the same rotation has the others within 2 r. Each other match thus allows an
// interval of rotations about the anchor; the rotation most intervals share is the hypothesis.
Hypothesis vote(std::size_t anchor, const std::vector<Matched>& points, double radius) {
  std::array<int, kRotationBins + 1> change{};
  const double reach = 2 * radius;
  const double bins_per_radian = kRotationBins / (2 * std::numbers::pi);
  const auto add = [&](int first, int last) {  // both included, within [0, kRotationBins)
    ++change[static_cast<std::size_t>(first)];
    --change[static_cast<std::size_t>(last) + 1];
  };
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (j == anchor) continue;
    const Eigen::Vector2d v = points[j].query - points[anchor].query;
    const Eigen::Vector2d w = points[j].reference - points[anchor].reference;
    const double length_v = v.norm(), length_w = w.norm();
    // Too near to tell a rotation, or not the same distance.
    if (std::min(length_v, length_w) <= reach || std::abs(length_v - length_w) > reach) continue;
    const double angle = std::atan2(w.x() * v.y() - w.y() * v.x(), w.dot(v)) + std::numbers::pi;
    // |R w - v| <= reach where the chord's angle is within this of the exact one.
    const double along = length_v - length_w;
    const double chord = (reach * reach - along * along) / (4 * length_v * length_w);
    const double half = 2 * std::asin(std::sqrt(std::min(1.0, std::max(0.0, chord))));
    const int first = static_cast<int>(std::floor((angle - half) * bins_per_radian));
    const int last = std::min(static_cast<int>(std::floor((angle + half) * bins_per_radian)),
                              first + kRotationBins - 1);
    if (first < 0) {
      add(first + kRotationBins, kRotationBins - 1);
      if (last >= 0) add(0, last);
    } else if (last >= kRotationBins) {
      add(first, kRotationBins - 1);
      add(0, last - kRotationBins);
    } else {
      add(first, last);
    }
  }
  Hypothesis best{anchor, 0.0, 0};
  int votes = 0;
  for (int bin = 0; bin < kRotationBins; ++bin) {
    votes += change[static_cast<std::size_t>(bin)];
    if (votes > best.votes) {
      best = {anchor, (bin + 0.5) / bins_per_radian - std::numbers::pi, votes};
    }
  }
  return best;
}

Fitted by_voting(const std::vector<Matched>& points, std::span<const KeypointMatch> matches,
                 double radius) {
  std::vector<Hypothesis> hypotheses;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Hypothesis h = vote(i, points, radius);
    if (h.votes > 0) hypotheses.push_back(h);
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.votes > b.votes; });
  Fitted best;
  std::vector<bool> explained(points.size(), false);
  std::size_t tried = 0;
  for (const Hypothesis& h : hypotheses) {
    // Votes bound the inliers from above.
    if (tried == kHypotheses || h.votes + 1 <= static_cast<int>(best.inliers.size())) break;
    if (explained[h.anchor]) continue;
    ++tried;
    PlanarTransform T;
    T.angle = h.angle;
    T.translation = points[h.anchor].query - rotation_matrix(T) * points[h.anchor].reference;
    Fitted fitted = refine(T, 2 * radius, points, matches, radius);
    for (const std::size_t i : fitted.inliers) explained[i] = true;
    if (fitted.inliers.size() > best.inliers.size()) best = std::move(fitted);
  }
  return best;
}

// splitmix64: a generator that is the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::size_t below(std::size_t n) {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<std::size_t>((z ^ (z >> 31)) % n);
  }

 private:
  std::uint64_t state_;
};

Fitted by_ransac(const std::vector<Matched>& points, std::span<const KeypointMatch> matches,
                 const ConsensusOptions& options, std::uint64_t seed) {
  const std::size_t n = points.size();
  const std::size_t trials = ransac_trials(n, 6, options.miss_probability);
  const std::size_t pairs = n * (n - 1) / 2;
  std::vector<std::size_t> best;
  const auto attempt = [&](std::size_t i, std::size_t j) {
    const PlanarTransform T = fit(points, {i, j});
    std::vector<std::size_t> inliers = inliers_of(T, points, matches, options.inlier_radius);
    if (inliers.size() > best.size()) best = std::move(inliers);
  };
  if (pairs <= trials) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) attempt(i, j);
    }
  } else {
    Random random(seed);
    for (std::size_t t = 0; t < trials; ++t) {
      const std::size_t i = random.below(n), j = random.below(n - 1);
      attempt(i, j < i ? j : j + 1);
    }
  }
  if (best.size() < 2) return {};
  return refine(fit(points, best), options.inlier_radius, points, matches, options.inlier_radius);
}

}  // namespace

std::size_t ransac_trials(std::size_t matches, std::size_t inliers, double miss_probability) {
  if (matches < 2) return 0;
  if (inliers >= matches) return 1;
  const double n = static_cast<double>(matches), k = static_cast<double>(inliers);
  const double hit = k * (k - 1) / (n * (n - 1));
  return static_cast<std::size_t>(std::ceil(std::log(miss_probability) / std::log1p(-hit)));
}

Consensus find_consensus(const MapDescription& query, const MapDescription& reference,
                         std::span<const KeypointMatch> matches, const ConsensusOptions& options,
                         std::uint64_t seed) {
  Consensus result;
  if (matches.size() < 2) return result;
  const std::vector<Matched> points = positions(query, reference, matches);
  const Fitted fitted = options.method == "ransac"
                            ? by_ransac(points, matches, options, seed)
                            : by_voting(points, matches, options.inlier_radius);
  result.T_query_reference = fitted.T;
  for (const std::size_t i : fitted.inliers) result.inliers.push_back(matches[i]);
  return result;
}

}  // namespace groundloop
