#include "loopclosure/evaluation/reference_closures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frontend/core/parallel.hpp"
#include "loopclosure/evaluation/reference_alignment.hpp"

namespace groundloop {
namespace {

constexpr double kVoxelSize = 0.5;
// Below this no threshold is sensible, and the pair is not worth a line.
constexpr double kLeastOverlap = 0.01;
// Ground truth may be a metre off between visits: pairs that overlap this little at ground truth
// may overlap enough once aligned.
constexpr double kWorthAligning = 0.05;
constexpr double kMeetingDistance = 15.0;  // m between two ways that meet

// Unit direction of travel at scan i, from its neighbours.
Eigen::Vector3d heading(const std::vector<Pose>& T_world_scan, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, T_world_scan.size() - 1);
  const Eigen::Vector3d step = T_world_scan[after].translation - T_world_scan[before].translation;
  return step.norm() > 1e-6 ? Eigen::Vector3d(step.normalized()) : Eigen::Vector3d::Zero();
}

// Median distance and direction over the query's scans that come near the reference's way.
void classify(PairOverlap& pair, const EvaluatedMap& reference, const EvaluatedMap& query) {
  std::vector<double> distances;
  double cosine = 0.0;
  for (std::size_t i = 0; i < query.T_world_scan.size(); ++i) {
    double nearest = kMeetingDistance;
    std::size_t at = reference.T_world_scan.size();
    for (std::size_t j = 0; j < reference.T_world_scan.size(); ++j) {
      const double distance =
          (reference.T_world_scan[j].translation - query.T_world_scan[i].translation).norm();
      if (distance < nearest) nearest = distance, at = j;
    }
    if (at == reference.T_world_scan.size()) continue;
    distances.push_back(nearest);
    cosine += heading(query.T_world_scan, i).dot(heading(reference.T_world_scan, at));
  }
  if (distances.empty()) return;
  cosine /= static_cast<double>(distances.size());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  pair.distance = *middle;
  pair.direction = cosine > std::numbers::sqrt2 / 2    ? TravelDirection::same
                   : cosine < -std::numbers::sqrt2 / 2 ? TravelDirection::opposite
                                                       : TravelDirection::crossing;
}

bool comparable(const EvaluatedMap& reference, const EvaluatedMap& query,
                const ReferenceOptions& options) {
  return reference.known() && query.known() && is_eligible(reference.key, query.key, options);
}

// The pairs whose query is maps[q].
std::vector<PairOverlap> pairs_of(const std::vector<EvaluatedMap>& maps, std::size_t q,
                                  const ReferenceOptions& options) {
  const EvaluatedMap& query = maps[q];
  const OccupiedVoxels own(query.points, Pose(), kVoxelSize);
  const auto true_pose = [&](std::size_t r) {
    return query.T_world_map().inverse() * maps[r].T_world_map();
  };
  std::vector<double> overlaps(maps.size(), 0.0);
  parallel_for(maps.size(), 1, [&](std::size_t r) {
    if (!comparable(maps[r], query, options)) return;
    overlaps[r] = own.overlap(maps[r].points, true_pose(r));
  });
  const auto worth_aligning = [&](double overlap) {
    return options.align && overlap > kWorthAligning;
  };
  if (std::any_of(overlaps.begin(), overlaps.end(), worth_aligning)) {
    const ReferenceTarget target(query.points);
    parallel_for(maps.size(), 1, [&](std::size_t r) {
      if (!worth_aligning(overlaps[r])) return;
      const ReferenceAlignment aligned = reference_alignment(target, maps[r].points, true_pose(r));
      if (aligned.converged) {
        overlaps[r] = own.overlap(maps[r].points, aligned.T_query_reference);
      }
    });
  }
  std::vector<PairOverlap> found;
  for (std::size_t r = 0; r < maps.size(); ++r) {
    if (overlaps[r] <= kLeastOverlap) continue;
    PairOverlap pair{maps[r].key, query.key, overlaps[r], TravelDirection::apart, 0.0};
    classify(pair, maps[r], query);
    found.push_back(pair);
  }
  return found;
}

}  // namespace

const char* to_string(TravelDirection direction) {
  switch (direction) {
    case TravelDirection::same:
      return "same";
    case TravelDirection::opposite:
      return "opposite";
    case TravelDirection::crossing:
      return "crossing";
    case TravelDirection::apart:
      break;
  }
  return "apart";
}

bool is_eligible(const MapKey& reference, const MapKey& query, const ReferenceOptions& options) {
  if (reference.session != query.session) {
    return options.pairs != "within" && reference.session < query.session;
  }
  return options.pairs != "between" && reference.map < query.map - options.skipped_maps;
}

std::size_t count_eligible(const std::vector<EvaluatedMap>& maps, const ReferenceOptions& options) {
  std::size_t count = 0;
  for (const EvaluatedMap& query : maps) {
    for (const EvaluatedMap& reference : maps) {
      count += comparable(reference, query, options) ? 1 : 0;
    }
  }
  return count;
}

std::vector<PairOverlap> overlapping_pairs(const std::vector<EvaluatedMap>& maps,
                                           const ReferenceOptions& options,
                                           const Progress& progress) {
  std::vector<PairOverlap> pairs;
  for (std::size_t q = 0; q < maps.size(); ++q) {
    if (progress) progress("reference closures", q, maps.size());
    if (!maps[q].known()) continue;
    const std::vector<PairOverlap> found = pairs_of(maps, q, options);
    pairs.insert(pairs.end(), found.begin(), found.end());
  }
  return pairs;
}

double overlap_threshold(const MapKey& reference, const MapKey& query,
                         const ReferenceOptions& options) {
  return reference.session == query.session ? options.overlap : options.overlap_between_sessions;
}

bool is_reference(const PairOverlap& pair, const ReferenceOptions& options) {
  return pair.overlap > overlap_threshold(pair.reference, pair.query, options);
}

bool is_uncertain(const PairOverlap& pair, const ReferenceOptions& options) {
  const double threshold = overlap_threshold(pair.reference, pair.query, options);
  return std::abs(pair.overlap - threshold) <= options.uncertain_share * threshold;
}

}  // namespace groundloop
