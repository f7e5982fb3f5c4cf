// Evaluation of closures against reference closures (Sec. 4.4 and 4.5 of the paper): of
// groundloop's own, and of any detector's list. It shares neither overlap nor registration with the
// verification it judges.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "frontend/core/options.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/core/scan.hpp"
#include "loopclosure/evaluation/precision_recall.hpp"
#include "loopclosure/evaluation/reference_closures.hpp"
#include "loopclosure/loop_closure.hpp"

namespace groundloop {

struct ClosureEvaluationOptions {
  ReferenceOptions references;
  double threshold = 6.0;
  double right_m = 3.0;
  double right_deg = 5.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("threshold", self.threshold, Range{-1e9, 1e9}, "",
          "score from which a closure is counted as detected; inliers where they are the score");
    field("right_m", self.right_m, Range{0.01, 100.0}, "m",
          "error of a right pose where the maps meet");
    field("right_deg", self.right_deg, Range{0.01, 180.0}, "deg", "the same in rotation");
  }
};

/// A pair that was reported.
struct ReportedClosure {
  MapKey reference, query;
  bool detector = true;   ///< else found from the solution
  bool accepted = false;  ///< in the final graph
  double score = 0.0;     ///< more is surer; inliers, for groundloop
  /// Refined, and the detector's own; empty where none was reported.
  std::optional<Pose> T_query_reference, initial_T_query_reference;
};

struct PoseError {
  double translation_m = 0.0, rotation_deg = 0.0;
};

/// What a reported closure turned out to be.
struct JudgedClosure {
  ReportedClosure closure;
  double overlap = 0.0;  ///< of the reference maps
  bool correct = false;  ///< its pair is a reference closure
  bool uncertain = false;
  /// Of the initial and the refined pose, where the maps meet and at their origins, drift inside
  /// the maps included; empty without a pose.
  std::optional<PoseError> initial_meeting, refined_meeting, initial_origin, refined_origin;
  bool initial_right = false, refined_right = false;  ///< where the maps meet
};

struct ReferenceClosure : PairOverlap {
  bool uncertain = false;
  bool detected = false;  ///< by the detector, at the threshold
  bool in_final_graph = false;
};

struct ErrorStatistics {
  std::size_t count = 0;
  double median = 0.0, mean = 0.0, rmse = 0.0, max = 0.0;
};
struct PoseErrors {
  ErrorStatistics translation_m, rotation_deg;
};

struct DetectionCounts {
  std::size_t true_positives = 0, false_positives = 0;
  std::size_t true_wrong_pose = 0;   ///< of the true, those whose pose is wrong where they meet
  std::size_t false_right_pose = 0;  ///< of the false, those whose pose is right all the same
  std::size_t wrong_pose = 0;        ///< of all
  std::optional<double> precision, recall;
};

struct ClosureEvaluation {
  std::size_t eligible = 0;  ///< pairs that could have been reported
  std::size_t dropped = 0;   ///< reported, but not eligible, or of a map without ground truth
  std::vector<ReferenceClosure> references;
  std::vector<JudgedClosure> judged;  ///< in the order of their queries
  /// Over the scores of the detector's closures: all; without uncertain pairs; true only where the
  /// pose is right.
  PrecisionRecall detector, certain, with_right_pose;
  DetectionCounts at_threshold;  ///< the detector's closures, initial poses
  DetectionCounts final_graph;   ///< accepted closures of either source, refined poses
  /// Of the detector's true closures at the threshold (initial), and of those in the final graph
  /// (refined). The proxy is point-to-point ICP of the session's own maps started at ground truth.
  PoseErrors initial_meeting, refined_meeting, initial_absolute, refined_absolute, initial_to_proxy,
      refined_to_proxy;
  /// Root mean square of overlap at the initial pose less overlap of the reference maps, over true
  /// detector closures with a score of at least five (Tables 5 and 8).
  std::optional<double> overlap_rmse;
  std::size_t overlap_closures = 0;

  [[nodiscard]] std::size_t uncertain_references() const;
};

/// `pairs` are the overlapping pairs of `maps`. `load_map` gives the session's own points of a map;
/// without it nothing is compared with ICP, and there is no overlap error. Closures between maps
/// that are not among `maps` are an error (InputError).
[[nodiscard]] ClosureEvaluation evaluate_closures(
    const std::vector<EvaluatedMap>& maps, const std::vector<PairOverlap>& pairs,
    const std::vector<ReportedClosure>& closures,
    const std::function<Points(const MapKey&)>& load_map, const ClosureEvaluationOptions& options,
    const Progress& progress = {});

}  // namespace groundloop
