#include "loopclosure/evaluation/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"
#include "loopclosure/evaluation/reference_alignment.hpp"

namespace groundloop {
namespace {

constexpr double kVoxelSize = 0.5;
// Ground truth may be a metre off between visits: pairs that overlap this little at ground truth
// may overlap enough once aligned.
constexpr double kWorthAligning = 0.05;
constexpr int kOverlapInliers = 5;         // of Tables 5 and 8
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
  const OccupiedVoxels own(query.points, Pose(), kVoxelSize);
  const auto true_pose = [&](std::size_t r) {
    return query.T_world_map.inverse() * maps[r].T_world_map;
  };
  std::vector<double> overlaps(maps.size(), 0.0);
  parallel_for(maps.size(), 1, [&](std::size_t r) {
    if (!comes_before(maps[r].key, query.key, options.skipped_maps)) return;
    overlaps[r] = own.overlap(maps[r].points, true_pose(r));
  });
  const auto worth_aligning = [&](double overlap) {
    return options.align_references && overlap > kWorthAligning;
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
  std::vector<ReferenceClosure> found;
  for (std::size_t r = 0; r < maps.size(); ++r) {
    const EvaluatedMap& reference = maps[r];
    const bool same_session = reference.key.session == query.key.session;
    if (overlaps[r] <= (same_session ? options.overlap : options.overlap_between_sessions)) {
      continue;
    }
    ReferenceClosure closure;
    closure.reference = reference.key;
    closure.query = query.key;
    closure.overlap = overlaps[r];
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

// Judges closures one after the other, those of one query together.
class Judge {
 public:
  Judge(const std::vector<EvaluatedMap>& maps, std::vector<ReferenceClosure>& references,
        const std::function<Points(const MapKey&)>& load_map,
        const ClosureEvaluationOptions& options)
      : maps_(maps), references_(references), load_map_(load_map), options_(options) {
    for (std::size_t i = 0; i < maps.size(); ++i) map_index_[maps[i].key] = i;
    for (std::size_t i = 0; i < references.size(); ++i) {
      reference_index_[{references[i].reference, references[i].query}] = i;
    }
  }

  void judge(const ReportedClosure& closure, ClosureEvaluation& result) {
    const auto reference = reference_index_.find({closure.reference, closure.query});
    const bool correct = reference != reference_index_.end();
    const bool detected = closure.detector && closure.inliers >= options_.min_inliers;
    const Pose truth =
        true_pose(closure.query).inverse() * true_pose(closure.reference);  // T_query_reference
    if (closure.detector) scored_.push_back({static_cast<double>(closure.inliers), correct});
    if (detected) {
      count(result.detector_accepted, correct, aligned(closure.initial_T_query_reference, truth));
    }
    if (closure.accepted) {
      count(result.final_graph, correct, aligned(closure.T_query_reference, truth));
    }
    if (!correct) return;
    ReferenceClosure& found = references_[reference->second];
    found.detected = found.detected || detected;
    found.in_final_graph = found.in_final_graph || closure.accepted;
    measure(closure, detected, truth, found.overlap);
  }

  void finish(ClosureEvaluation& result) {
    result.detector = precision_recall(std::move(scored_), references_.size());
    result.initial_to_proxy = statistics(initial_to_proxy_);
    result.initial_absolute = statistics(initial_absolute_);
    result.refined_to_proxy = statistics(refined_to_proxy_);
    result.refined_absolute = statistics(refined_absolute_);
    result.overlap_closures = overlap_differences_.size();
    if (!overlap_differences_.empty()) {
      result.overlap_rmse = statistics(overlap_differences_).rmse;
    }
  }

 private:
  [[nodiscard]] const Pose& true_pose(const MapKey& key) const {
    const auto found = map_index_.find(key);
    if (found == map_index_.end()) {
      throw InputError("closures.csv: map " + std::to_string(key.map) +
                       " is not in local_maps.csv; run the session again");
    }
    return maps_[found->second].T_world_map;
  }

  [[nodiscard]] bool aligned(const Pose& T, const Pose& truth) const {
    const PoseError e = error_of(T, truth);
    return e.translation_m <= options_.aligned_m && e.rotation_deg <= options_.aligned_deg;
  }

  // Errors of a true closure.
  void measure(const ReportedClosure& closure, bool detected, const Pose& truth,
               double reference_overlap_of_maps) {
    const bool for_overlap = closure.detector && closure.inliers >= kOverlapInliers;
    if (!detected && !closure.accepted && !for_overlap) return;
    if (!target_ || loaded_ != closure.query) {
      loaded_ = closure.query;
      query_points_ = load_map_(closure.query);
      target_ = std::make_unique<ReferenceTarget>(query_points_);
    }
    const Points reference_points = load_map_(closure.reference);
    const ReferenceAlignment proxy = reference_alignment(*target_, reference_points, truth);
    if (detected) {
      add(closure.initial_T_query_reference, truth, proxy, initial_absolute_, initial_to_proxy_);
    }
    if (closure.accepted) {
      add(closure.T_query_reference, truth, proxy, refined_absolute_, refined_to_proxy_);
    }
    if (for_overlap) {
      const double overlap = reference_overlap(reference_points, query_points_,
                                               closure.initial_T_query_reference, kVoxelSize);
      overlap_differences_.push_back(overlap - reference_overlap_of_maps);
    }
  }

  static void add(const Pose& T, const Pose& truth, const ReferenceAlignment& proxy,
                  std::vector<PoseError>& absolute, std::vector<PoseError>& to_proxy) {
    absolute.push_back(error_of(T, truth));
    if (proxy.converged) to_proxy.push_back(error_of(T, proxy.T_query_reference));
  }

  const std::vector<EvaluatedMap>& maps_;
  std::vector<ReferenceClosure>& references_;
  const std::function<Points(const MapKey&)>& load_map_;
  const ClosureEvaluationOptions& options_;
  std::map<MapKey, std::size_t> map_index_;
  std::map<Pair, std::size_t> reference_index_;
  std::vector<ScoredClosure> scored_;
  std::vector<PoseError> initial_to_proxy_, initial_absolute_, refined_to_proxy_, refined_absolute_;
  std::vector<double> overlap_differences_;
  MapKey loaded_;
  Points query_points_;
  std::unique_ptr<ReferenceTarget> target_;
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
  for (std::size_t q = 0; q < maps.size(); ++q) {
    if (progress) progress("reference closures", q, maps.size());
    const std::vector<ReferenceClosure> found = references_of(maps, q, options);
    result.references.insert(result.references.end(), found.begin(), found.end());
  }
  std::vector<ReportedClosure> ordered = closures;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.query < b.query; });
  Judge judge(maps, result.references, load_map, options);
  for (std::size_t c = 0; c < ordered.size(); ++c) {
    if (progress) progress("closures", c, ordered.size());
    judge.judge(ordered[c], result);
  }
  judge.finish(result);
  finish(result.detector_accepted, result.references.size());
  finish(result.final_graph, result.references.size());
  return result;
}

}  // namespace groundloop
