#include "loopclosure/evaluation/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "frontend/core/error.hpp"
#include "loopclosure/evaluation/reference_alignment.hpp"

namespace groundloop {
namespace {

constexpr double kVoxelSize = 0.5;
constexpr double kOverlapScore = 5;  // of Tables 5 and 8

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

// Counts one closure among the true or the false.
void count(DetectionCounts& counts, bool correct, bool right) {
  (correct ? counts.true_positives : counts.false_positives) += 1;
  counts.true_wrong_pose += correct && !right ? 1 : 0;
  counts.false_right_pose += !correct && right ? 1 : 0;
  counts.wrong_pose += right ? 0 : 1;
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
  Judge(const std::vector<EvaluatedMap>& maps, const std::vector<PairOverlap>& pairs,
        const std::function<Points(const MapKey&)>& load_map,
        const ClosureEvaluationOptions& options, ClosureEvaluation& result)
      : maps_(maps), load_map_(load_map), options_(options), result_(result) {
    for (std::size_t i = 0; i < maps.size(); ++i) map_index_[maps[i].key] = i;
    for (const PairOverlap& pair : pairs) {
      pairs_[{pair.reference, pair.query}] = pair;
      if (!is_reference(pair, options.references)) continue;
      reference_index_[{pair.reference, pair.query}] = result.references.size();
      ReferenceClosure reference;
      static_cast<PairOverlap&>(reference) = pair;
      reference.uncertain = is_uncertain(pair, options.references);
      result.references.push_back(reference);
    }
  }

  void judge(const ReportedClosure& closure) {
    const EvaluatedMap &reference = map(closure.reference), &query = map(closure.query);
    if (!reference.known() || !query.known() ||
        !is_eligible(closure.reference, closure.query, options_.references)) {
      ++result_.dropped;
      return;
    }
    JudgedClosure judged;
    judged.closure = closure;
    const auto pair = pairs_.find({closure.reference, closure.query});
    if (pair != pairs_.end()) {
      judged.overlap = pair->second.overlap;
      judged.correct = is_reference(pair->second, options_.references);
      judged.uncertain = is_uncertain(pair->second, options_.references);
    }
    measure_poses(judged, reference, query);
    const bool detected = closure.detector && closure.score >= options_.threshold;
    if (detected) count(result_.at_threshold, judged.correct, judged.initial_right);
    if (closure.accepted) count(result_.final_graph, judged.correct, judged.refined_right);
    if (judged.correct) {
      ReferenceClosure& found =
          result_.references[reference_index_.at({closure.reference, closure.query})];
      found.detected = found.detected || detected;
      found.in_final_graph = found.in_final_graph || closure.accepted;
      add_errors(judged, detected);
      compare_with_icp(judged, detected, reference, query);
    }
    result_.judged.push_back(std::move(judged));
  }

  void finish() {
    add_curves();
    result_.initial_meeting = statistics(initial_meeting_);
    result_.refined_meeting = statistics(refined_meeting_);
    result_.initial_absolute = statistics(initial_origin_);
    result_.refined_absolute = statistics(refined_origin_);
    result_.initial_to_proxy = statistics(initial_to_proxy_);
    result_.refined_to_proxy = statistics(refined_to_proxy_);
    result_.overlap_closures = overlap_differences_.size();
    if (!overlap_differences_.empty()) {
      result_.overlap_rmse = statistics(overlap_differences_).rmse;
    }
    groundloop::finish(result_.at_threshold, result_.references.size());
    groundloop::finish(result_.final_graph, result_.references.size());
  }

 private:
  [[nodiscard]] const EvaluatedMap& map(const MapKey& key) const {
    const auto found = map_index_.find(key);
    if (found == map_index_.end()) {
      throw InputError("a closure names map " + std::to_string(key.map) +
                       ", which the session does not have; give closures of this session");
    }
    return maps_[found->second];
  }

  void measure_poses(JudgedClosure& judged, const EvaluatedMap& reference,
                     const EvaluatedMap& query) const {
    const ReportedClosure& closure = judged.closure;
    if (!closure.initial_T_query_reference && !closure.T_query_reference) return;
    const Pose truth = query.T_world_map().inverse() * reference.T_world_map();
    const MeetingScans scans = meeting_scans(reference, query);
    const Pose meeting = true_at_meeting(reference, query, scans);
    const auto measure = [&](const std::optional<Pose>& T, std::optional<PoseError>& at_scans,
                             std::optional<PoseError>& at_origins) {
      if (!T) return false;
      at_scans = error_of(at_meeting(*T, reference, query, scans), meeting);
      at_origins = error_of(*T, truth);
      return at_scans->translation_m <= options_.right_m &&
             at_scans->rotation_deg <= options_.right_deg;
    };
    judged.initial_right =
        measure(closure.initial_T_query_reference, judged.initial_meeting, judged.initial_origin);
    judged.refined_right =
        measure(closure.T_query_reference, judged.refined_meeting, judged.refined_origin);
  }

  void add_errors(const JudgedClosure& judged, bool detected) {
    if (detected && judged.initial_meeting) {
      initial_meeting_.push_back(*judged.initial_meeting);
      initial_origin_.push_back(*judged.initial_origin);
    }
    if (judged.closure.accepted && judged.refined_meeting) {
      refined_meeting_.push_back(*judged.refined_meeting);
      refined_origin_.push_back(*judged.refined_origin);
    }
  }

  // Of a true closure.
  void compare_with_icp(const JudgedClosure& judged, bool detected, const EvaluatedMap& reference,
                        const EvaluatedMap& query) {
    const ReportedClosure& closure = judged.closure;
    const bool initial = closure.initial_T_query_reference.has_value();
    const bool for_overlap = closure.detector && closure.score >= kOverlapScore && initial;
    const bool for_initial = detected && initial;
    const bool for_refined = closure.accepted && closure.T_query_reference.has_value();
    if (!load_map_ || !(for_initial || for_refined || for_overlap)) return;
    if (!target_ || loaded_ != closure.query) {
      loaded_ = closure.query;
      query_points_ = load_map_(closure.query);
      target_ = std::make_unique<ReferenceTarget>(query_points_);
    }
    const Points reference_points = load_map_(closure.reference);
    const Pose truth = query.T_world_map().inverse() * reference.T_world_map();
    const ReferenceAlignment proxy = reference_alignment(*target_, reference_points, truth);
    if (proxy.converged && for_initial) {
      initial_to_proxy_.push_back(
          error_of(*closure.initial_T_query_reference, proxy.T_query_reference));
    }
    if (proxy.converged && for_refined) {
      refined_to_proxy_.push_back(error_of(*closure.T_query_reference, proxy.T_query_reference));
    }
    if (for_overlap) {
      const double overlap = reference_overlap(reference_points, query_points_,
                                               *closure.initial_T_query_reference, kVoxelSize);
      overlap_differences_.push_back(overlap - judged.overlap);
    }
  }

  void add_curves() {
    std::vector<ScoredClosure> all, certain, posed;
    for (const JudgedClosure& j : result_.judged) {
      if (!j.closure.detector) continue;
      all.push_back({j.closure.score, j.correct});
      posed.push_back({j.closure.score, j.correct && j.initial_right});
      if (!j.uncertain) certain.push_back({j.closure.score, j.correct});
    }
    const std::size_t references = result_.references.size();
    result_.detector = precision_recall(std::move(all), references);
    result_.with_right_pose = precision_recall(std::move(posed), references);
    result_.certain =
        precision_recall(std::move(certain), references - result_.uncertain_references());
  }

  const std::vector<EvaluatedMap>& maps_;
  const std::function<Points(const MapKey&)>& load_map_;
  const ClosureEvaluationOptions& options_;
  ClosureEvaluation& result_;
  std::map<MapKey, std::size_t> map_index_;
  std::map<std::pair<MapKey, MapKey>, PairOverlap> pairs_;
  std::map<std::pair<MapKey, MapKey>, std::size_t> reference_index_;
  std::vector<PoseError> initial_meeting_, refined_meeting_, initial_origin_, refined_origin_,
      initial_to_proxy_, refined_to_proxy_;
  std::vector<double> overlap_differences_;
  MapKey loaded_;
  Points query_points_;
  std::unique_ptr<ReferenceTarget> target_;
};

}  // namespace

std::size_t ClosureEvaluation::uncertain_references() const {
  return static_cast<std::size_t>(std::count_if(
      references.begin(), references.end(), [](const ReferenceClosure& r) { return r.uncertain; }));
}

ClosureEvaluation evaluate_closures(const std::vector<EvaluatedMap>& maps,
                                    const std::vector<PairOverlap>& pairs,
                                    const std::vector<ReportedClosure>& closures,
                                    const std::function<Points(const MapKey&)>& load_map,
                                    const ClosureEvaluationOptions& options,
                                    const Progress& progress) {
  ClosureEvaluation result;
  result.eligible = count_eligible(maps, options.references);
  std::vector<ReportedClosure> ordered = closures;
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) {
    return std::pair(a.query, a.reference) < std::pair(b.query, b.reference);
  });
  Judge judge(maps, pairs, load_map, options, result);
  for (std::size_t c = 0; c < ordered.size(); ++c) {
    if (progress) progress("closures", c, ordered.size());
    judge.judge(ordered[c]);
  }
  judge.finish();
  return result;
}

}  // namespace groundloop
