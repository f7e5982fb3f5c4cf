#include "loopclosure/consensus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>
#include <utility>

#include "loopclosure/hamming.hpp"

namespace groundloop {
namespace {

constexpr int kRotationBins = 360;
constexpr std::size_t kHypotheses = 32;
constexpr int kRefinements = 10;

struct Matched {
  Eigen::Vector2d query, reference;
  double turn;  // orientation of the query keypoint less that of the reference keypoint
};

// How far an inlier may be off, in metres and radians, and whether its keypoints are its own.
struct Tolerance {
  double radius, turn;
  bool unique = true;
};

// Between two angles of (-pi, pi]: at most pi. What std::remainder gives, at a tenth of its cost.
double angle_between(double a, double b) {
  const double difference = std::abs(a - b);
  return difference > std::numbers::pi ? 2 * std::numbers::pi - difference : difference;
}

// Those with the nearest descriptors, nearest first, where there are more than `limit`. Voting
// grows with the square of the matches; maps with many are full of repetition, where the nearest
// are as good as all of them.
std::vector<KeypointMatch> nearest_matches(std::span<const KeypointMatch> matches,
                                           std::size_t limit) {
  std::vector<KeypointMatch> result(matches.begin(), matches.end());
  if (limit == 0 || result.size() <= limit) return result;
  std::stable_sort(
      result.begin(), result.end(),
      [](const KeypointMatch& a, const KeypointMatch& b) { return a.distance < b.distance; });
  result.resize(limit);
  return result;
}

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

// Indices of matches within `radius` of the alignment; where keypoints are to be unique each once:
// the nearer descriptor first, then the nearer point.
std::vector<std::size_t> inliers_of(const PlanarTransform& T, const std::vector<Matched>& points,
                                    std::span<const KeypointMatch> matches,
                                    const Tolerance& tolerance) {
  struct Near {
    int distance;
    double error;
    std::size_t index;
  };
  std::vector<Near> near;
  const Eigen::Matrix2d R = rotation_matrix(T);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = (R * points[i].reference + T.translation - points[i].query).squaredNorm();
    if (error > tolerance.radius * tolerance.radius) continue;
    if (angle_between(points[i].turn, T.angle) > tolerance.turn) continue;
    near.push_back({matches[i].distance, error, i});
  }
  std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
    return std::tie(a.distance, a.error, a.index) < std::tie(b.distance, b.error, b.index);
  });
  std::vector<std::size_t> chosen;
  for (const Near& n : near) {
    const bool taken =
        tolerance.unique && std::any_of(chosen.begin(), chosen.end(), [&](std::size_t c) {
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
              std::span<const KeypointMatch> matches, const Tolerance& tolerance) {
  Fitted best{start, inliers_of(start, points, matches, tolerance)};
  std::vector<std::size_t> support =
      inliers_of(start, points, matches, {start_radius, tolerance.turn, tolerance.unique});
  for (int i = 0; i < kRefinements && support.size() >= 2; ++i) {
    const PlanarTransform T = fit(points, support);
    std::vector<std::size_t> inliers = inliers_of(T, points, matches, tolerance);
    const bool better = inliers.size() > best.inliers.size() || i == 0;
    if (!better) break;
    if (inliers.size() >= best.inliers.size()) best = {T, inliers};
    support = std::move(inliers);
  }
  return best;
}

// Bins of rotation [first, last], last possibly beyond the end, where it goes on at bin 0.
struct RotationRange {
  int first = 0, last = -1;  // empty
  [[nodiscard]] bool holds(int bin) const {
    return (first <= bin && bin <= last) || bin + kRotationBins <= last;
  }
};

// The first and cheapest question to two matches; few pairs pass it.
bool turn_alike(const Matched& a, const Matched& b, const Tolerance& tolerance) {
  return angle_between(a.turn, b.turn) <= 2 * tolerance.turn;
}

// If an alignment has two matches as inliers of radius r, then the one that carries the first of
// them (the anchor) exactly, with the same rotation, has the other within 2 r. These are the
// rotations for which that is so.
RotationRange allowed_rotations(const Matched& anchor, const Matched& other,
                                const Tolerance& tolerance) {
  if (!turn_alike(anchor, other, tolerance)) return {};
  const double reach = 2 * tolerance.radius;
  const Eigen::Vector2d v = other.query - anchor.query;
  const Eigen::Vector2d w = other.reference - anchor.reference;
  const double length_v = v.norm(), length_w = w.norm();
  const double along = length_v - length_w;
  // Too near to tell a rotation, or not the same distance.
  if (std::min(length_v, length_w) <= reach || std::abs(along) > reach) return {};
  const double turn = std::atan2(w.x() * v.y() - w.y() * v.x(), w.dot(v));
  // |R w - v| <= reach where the rotation is within this of the exact one.
  const double chord = (reach * reach - along * along) / (4 * length_v * length_w);
  const double half = 2 * std::asin(std::sqrt(std::min(1.0, chord)));
  if (angle_between(turn, other.turn) > tolerance.turn + half) return {};
  const double bins_per_radian = kRotationBins / (2 * std::numbers::pi);
  const auto bin = [&](double angle) {
    return static_cast<int>(std::floor((angle + std::numbers::pi) * bins_per_radian));
  };
  RotationRange range{bin(turn - half), bin(turn + half)};
  range.last = std::min(range.last, range.first + kRotationBins - 1);
  if (range.first < 0) range.first += kRotationBins, range.last += kRotationBins;
  if (range.first >= kRotationBins) range.first -= kRotationBins, range.last -= kRotationBins;
  return range;
}

// The rotation about one match that most others allow.
struct Hypothesis {
  std::size_t anchor = 0;
  int bin = 0;
  int votes = 0;
};

Hypothesis vote(std::size_t anchor, const std::vector<Matched>& points,
                const Tolerance& tolerance) {
  std::array<int, kRotationBins + 1> change;
  int ranges = 0;
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (!turn_alike(points[anchor], points[j], tolerance) || j == anchor) continue;
    const RotationRange range = allowed_rotations(points[anchor], points[j], tolerance);
    if (range.last < range.first) continue;
    if (ranges++ == 0) change.fill(0);
    ++change[static_cast<std::size_t>(range.first)];
    if (range.last < kRotationBins) {
      --change[static_cast<std::size_t>(range.last) + 1];
    } else {
      ++change[0];
      --change[static_cast<std::size_t>(range.last - kRotationBins) + 1];
    }
  }
  Hypothesis best{anchor, 0, 0};
  if (ranges == 0) return best;
  int votes = 0;
  for (int bin = 0; bin < kRotationBins; ++bin) {
    votes += change[static_cast<std::size_t>(bin)];
    if (votes > best.votes) best = {anchor, bin, votes};
  }
  return best;
}

Fitted by_voting(const std::vector<Matched>& points, std::span<const KeypointMatch> matches,
                 const Tolerance& tolerance) {
  std::vector<Hypothesis> hypotheses;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Hypothesis h = vote(i, points, tolerance);
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
    std::vector<std::size_t> voters{h.anchor};
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j == h.anchor) continue;
      if (allowed_rotations(points[h.anchor], points[j], tolerance).holds(h.bin)) {
        voters.push_back(j);
      }
    }
    Fitted fitted = refine(fit(points, voters), 2 * tolerance.radius, points, matches, tolerance);
    for (const std::size_t i : fitted.inliers) explained[i] = true;
    if (fitted.inliers.size() > best.inliers.size()) best = std::move(fitted);
  }
  return best;
}

// Every pair of keypoints within twice the radius under T, with similar descriptors: what a search
// over the whole database missed or could not afford.
std::vector<KeypointMatch> matches_under(const PlanarTransform& T, const MapDescription& query,
                                         const MapDescription& reference, double radius,
                                         int max_distance) {
  // Query keypoints in order of x, so that those near a position are a short run.
  struct ByX {
    float x, y;
    std::uint32_t index;
  };
  std::vector<ByX> by_x;
  by_x.reserve(query.keypoints.size());
  for (std::uint32_t i = 0; i < query.keypoints.size(); ++i) {
    by_x.push_back({query.keypoints[i].x(), query.keypoints[i].y(), i});
  }
  std::sort(by_x.begin(), by_x.end(), [](const ByX& a, const ByX& b) {
    return std::tie(a.x, a.index) < std::tie(b.x, b.index);
  });
  const Eigen::Matrix2f R = rotation_matrix(T).cast<float>();
  const Eigen::Vector2f t = T.translation.cast<float>();
  const auto reach = static_cast<float>(2 * radius);
  std::vector<KeypointMatch> result;
  for (std::uint32_t r = 0; r < reference.keypoints.size(); ++r) {
    const Eigen::Vector2f p = R * reference.keypoints[r] + t;
    auto it = std::lower_bound(by_x.begin(), by_x.end(), p.x() - reach,
                               [](const ByX& k, float x) { return k.x < x; });
    for (; it != by_x.end() && it->x <= p.x() + reach; ++it) {
      const float dx = it->x - p.x(), dy = it->y - p.y();
      if (dx * dx + dy * dy > reach * reach) continue;
      const int distance = hamming_distance(query.descriptors[it->index], reference.descriptors[r]);
      if (distance <= max_distance) result.push_back({it->index, r, distance});
    }
  }
  return result;
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
                 const ConsensusOptions& options, const Tolerance& tolerance, std::uint64_t seed) {
  const std::size_t n = points.size();
  const std::size_t trials = options.trials > 0 ? static_cast<std::size_t>(options.trials)
                                                : ransac_trials(n, 6, options.miss_probability);
  const std::size_t pairs = n * (n - 1) / 2;
  std::vector<std::size_t> best;
  const auto attempt = [&](std::size_t i, std::size_t j) {
    const PlanarTransform T = fit(points, {i, j});
    std::vector<std::size_t> inliers = inliers_of(T, points, matches, tolerance);
    if (inliers.size() > best.size()) best = std::move(inliers);
  };
  if (pairs <= trials) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) attempt(i, j);
    }
  } else {
    Random random(seed + static_cast<std::uint64_t>(options.seed) * 0x9e3779b97f4a7c15ULL);
    for (std::size_t t = 0; t < trials; ++t) {
      const std::size_t i = random.below(n), j = random.below(n - 1);
      attempt(i, j < i ? j : j + 1);
    }
  }
  if (best.size() < 2) return {};
  if (!options.refinement) return {fit(points, best), best};
  return refine(fit(points, best), tolerance.radius, points, matches, tolerance);
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
  const std::vector<KeypointMatch> nearest =
      nearest_matches(matches, static_cast<std::size_t>(options.max_matches));
  matches = nearest;
  const Tolerance tolerance{options.inlier_radius,
                            options.orientation_gate_deg * std::numbers::pi / 180,
                            options.unique_keypoints};
  std::vector<Matched> points = positions(query, reference, matches);
  Fitted fitted = options.method == "ransac" ? by_ransac(points, matches, options, tolerance, seed)
                                             : by_voting(points, matches, tolerance);
  std::vector<KeypointMatch> guided;
  if (options.guided_bits > 0 && fitted.inliers.size() >= 2) {
    guided = matches_under(fitted.T, query, reference, options.inlier_radius, options.guided_bits);
    points = positions(query, reference, guided);
    Fitted again = refine(fitted.T, options.inlier_radius, points, guided,
                          {options.guided_radius, tolerance.turn, tolerance.unique});
    if (again.inliers.size() >= fitted.inliers.size()) {
      fitted = std::move(again);
      matches = guided;
    }
  }
  result.T_query_reference = fitted.T;
  for (const std::size_t i : fitted.inliers) result.inliers.push_back(matches[i]);
  return result;
}

}  // namespace groundloop
