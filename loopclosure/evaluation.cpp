#include "loopclosure/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "frontend/core/error.hpp"
#include "loopclosure/reference_alignment.hpp"

namespace groundloop {
namespace {

constexpr double kVoxelSize = 0.5;
// Ground truth may be a metre off between visits: pairs that overlap this little at ground truth
// may overlap enough once aligned.
constexpr double kWorthAligning = 0.05;
constexpr double kMeetingDistance = 15.0;  // m between two ways that meet

using Pair = std::pair<MapKey, MapKey>;  // reference, query

struct PoseError {
  double translation_m, rotation_deg;
};
PoseError error_of(const Pose& T, const Pose& expected) {
  const Pose difference = expected.inverse() * T;
  return {difference.translation.norm(),
          rotation_angle(difference.rotation) * 180 / std::numbers::pi};
}

ErrorStatistics statistics(std::vector<double> values) {
  ErrorStatistics result;
  result.count = values.size();
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  result.median =
      values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  result.max = values.back();
  double squares = 0.0;
  for (const double v : values) {
    result.mean += v / static_cast<double>(values.size());
    squares += v * v;
  }
  result.rmse = std::sqrt(squares / static_cast<double>(values.size()));
  return result;
}

PoseErrors statistics(const std::vector<PoseError>& errors) {
  std::vector<double> translation, rotation;
  for (const PoseError& e : errors) {
    translation.push_back(e.translation_m);
    rotation.push_back(e.rotation_deg);
  }
  return {statistics(std::move(translation)), statistics(std::move(rotation))};
}

// Unit direction of travel at scan i, from its neighbours.
Eigen::Vector3d heading(const std::vector<Eigen::Vector3d>& positions, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, positions.size() - 1);
  const Eigen::Vector3d step = positions[after] - positions[before];
  return step.norm() > 1e-6 ? Eigen::Vector3d(step.normalized()) : Eigen::Vector3d::Zero();
}

// Median distance and direction over the query's scans that come near the reference's way.
void classify(ReferenceClosure& closure, const EvaluatedMap& reference, const EvaluatedMap& query) {
  std::vector<double> distances;
  double cosine = 0.0;
  for (std::size_t i = 0; i < query.positions.size(); ++i) {
    double nearest = kMeetingDistance;
    std::size_t at = reference.positions.size();
    for (std::size_t j = 0; j < reference.positions.size(); ++j) {
      const double distance = (reference.positions[j] - query.positions[i]).norm();
      if (distance < nearest) nearest = distance, at = j;
    }
    if (at == reference.positions.size()) continue;
    distances.push_back(nearest);
    cosine += heading(query.positions, i).dot(heading(reference.positions, at));
  }
  if (distances.empty()) return;
  cosine /= static_cast<double>(distances.size());
  closure.distance = statistics(std::move(distances)).median;
  closure.direction = cosine > std::numbers::sqrt2 / 2    ? TravelDirection::same
                      : cosine < -std::numbers::sqrt2 / 2 ? TravelDirection::opposite
                                                          : TravelDirection::crossing;
}

bool comes_before(const MapKey& reference, const MapKey& query, int skipped) {
  return reference.session != query.session ? reference.session < query.session
                                            : reference.map < query.map - skipped;
}

// The reference closures whose query is maps[q].
std::vector<ReferenceClosure> references_of(const std::vector<EvaluatedMap>& maps, std::size_t q,
                                            const ClosureEvaluationOptions& options) {
  const EvaluatedMap& query = maps[q];
  const std::vector<std::uint64_t> own = occupied_voxels(query.points, Pose(), kVoxelSize);
  std::unique_ptr<ReferenceTarget> target;
  std::vector<ReferenceClosure> found;
  for (const EvaluatedMap& reference : maps) {
    if (!comes_before(reference.key, query.key, options.skipped_maps)) continue;
    Pose T = query.T_world_map.inverse() * reference.T_world_map;
    double overlap = shared_fraction(occupied_voxels(reference.points, T, kVoxelSize), own);
    if (options.align_references && overlap > kWorthAligning) {
      if (!target) target = std::make_unique<ReferenceTarget>(query.points);
      const ReferenceAlignment aligned = reference_alignment(*target, reference.points, T);
      if (aligned.converged) {
        overlap = shared_fraction(
            occupied_voxels(reference.points, aligned.T_query_reference, kVoxelSize), own);
      }
    }
    const bool same_session = reference.key.session == query.key.session;
    if (overlap <= (same_session ? options.overlap : options.overlap_between_sessions)) continue;
    ReferenceClosure closure;
    closure.reference = reference.key;
    closure.query = query.key;
    closure.overlap = overlap;
    classify(closure, reference, query);
    found.push_back(closure);
  }
  return found;
}

// Counts one closure among the true or the false.
void count(DetectionCounts& counts, bool correct, bool aligned) {
  (correct ? counts.true_positives : counts.false_positives) += 1;
  if (correct && !aligned) ++counts.misaligned;
  if (!correct && aligned) ++counts.below_overlap;
}

void finish(DetectionCounts& counts, std::size_t references) {
  const std::size_t reported = counts.true_positives + counts.false_positives;
  const auto correct = static_cast<double>(counts.true_positives);
  if (reported > 0) counts.precision = correct / static_cast<double>(reported);
  if (references > 0) counts.recall = correct / static_cast<double>(references);
}

// What the errors of all closures are gathered in.
struct Gathered {
  std::vector<PoseError> initial_to_proxy, initial_absolute, refined_to_proxy, refined_absolute;
  std::vector<double> overlap_differences;
};

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

ClosureEvaluation evaluate_closures(const std::vector<EvaluatedMap>& maps,
                                    const std::vector<ReportedClosure>& closures,
                                    const std::function<Points(const MapKey&)>& load_map,
                                    const ClosureEvaluationOptions& options,
                                    const Progress& progress) {
  ClosureEvaluation result;
  std::map<MapKey, std::size_t> index;
  for (std::size_t i = 0; i < maps.size(); ++i) index[maps[i].key] = i;

  std::vector<std::vector<ReferenceClosure>> by_query(maps.size());
  for (std::size_t q = 0; q < maps.size(); ++q) {
    if (progress) progress("reference closures", q, maps.size());
    by_query[q] = references_of(maps, q, options);
  }
  std::map<Pair, std::size_t> reference_index;
  for (const auto& found : by_query) {
    for (const ReferenceClosure& r : found) {
      reference_index[{r.reference, r.query}] = result.references.size();
      result.references.push_back(r);
    }
  }

  Gathered errors;
  std::vector<ScoredClosure> scored;
  MapKey loaded{-1, -1};
  Points query_points;
  std::unique_ptr<ReferenceTarget> target;
  std::vector<ReportedClosure> ordered = closures;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.query < b.query; });
  for (std::size_t c = 0; c < ordered.size(); ++c) {
    if (progress) progress("closures", c, ordered.size());
    const ReportedClosure& closure = ordered[c];
    if (!index.count(closure.reference) || !index.count(closure.query)) {
      throw InputError("closures.csv: map " + std::to_string(closure.reference.map) + " or " +
                       std::to_string(closure.query.map) + " is not in local_maps.csv");
    }
    const auto reference = reference_index.find({closure.reference, closure.query});
    const bool correct = reference != reference_index.end();
    const bool detected = closure.detector && closure.inliers >= options.min_inliers;
    const Pose truth = maps[index[closure.query]].T_world_map.inverse() *
                       maps[index[closure.reference]].T_world_map;
    const auto aligned = [&](const Pose& T) {
      const PoseError e = error_of(T, truth);
      return e.translation_m <= options.aligned_m && e.rotation_deg <= options.aligned_deg;
    };
    if (closure.detector) scored.push_back({static_cast<double>(closure.inliers), correct});
    if (detected) {
      count(result.detector_accepted, correct, aligned(closure.initial_T_query_reference));
    }
    if (closure.accepted) count(result.final_graph, correct, aligned(closure.T_query_reference));
    if (!correct) continue;
    ReferenceClosure& r = result.references[reference->second];
    r.detected = r.detected || detected;
    r.in_final_graph = r.in_final_graph || closure.accepted;
    const bool for_overlap = closure.detector && closure.inliers >= 5;
    if (!detected && !closure.accepted && !for_overlap) continue;

    if (loaded != closure.query) {
      loaded = closure.query;
      query_points = load_map(closure.query);
      target = std::make_unique<ReferenceTarget>(query_points);
    }
    const Points reference_points = load_map(closure.reference);
    const ReferenceAlignment proxy = reference_alignment(*target, reference_points, truth);
    if (detected) {
      errors.initial_absolute.push_back(error_of(closure.initial_T_query_reference, truth));
      if (proxy.converged) {
        errors.initial_to_proxy.push_back(
            error_of(closure.initial_T_query_reference, proxy.T_query_reference));
      }
    }
    if (closure.accepted) {
      errors.refined_absolute.push_back(error_of(closure.T_query_reference, truth));
      if (proxy.converged) {
        errors.refined_to_proxy.push_back(
            error_of(closure.T_query_reference, proxy.T_query_reference));
      }
    }
    if (for_overlap) {
      const double overlap = reference_overlap(reference_points, query_points,
                                               closure.initial_T_query_reference, kVoxelSize);
      errors.overlap_differences.push_back(overlap - r.overlap);
    }
  }
  result.detector = precision_recall(std::move(scored), result.references.size());
  finish(result.detector_accepted, result.references.size());
  finish(result.final_graph, result.references.size());
  result.initial_to_proxy = statistics(errors.initial_to_proxy);
  result.initial_absolute = statistics(errors.initial_absolute);
  result.refined_to_proxy = statistics(errors.refined_to_proxy);
  result.refined_absolute = statistics(errors.refined_absolute);
  result.overlap_closures = errors.overlap_differences.size();
  if (result.overlap_closures > 0)
    result.overlap_rmse = statistics(errors.overlap_differences).rmse;
  return result;
}

}  // namespace groundloop
