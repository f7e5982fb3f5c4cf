// Evaluation of closures against reference closures (Sec. 4.3 to 4.5 of the paper): pairs of local
// maps, rebuilt from the raw scans at ground-truth poses, that overlap. It shares neither overlap
// nor registration with the verification it judges.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "frontend/core/options.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/core/scan.hpp"
#include "loopclosure/evaluation/precision_recall.hpp"
#include "loopclosure/loop_closure.hpp"

namespace groundloop {

struct ClosureEvaluationOptions {
  double overlap = 0.25;
  double overlap_between_sessions = 0.10;
  int skipped_maps = 3;
  bool align_references = false;
  int min_inliers = 6;
  double aligned_m = 2.0;
  double aligned_deg = 5.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("overlap", self.overlap, Range{0.0, 1.0}, "", "of a reference closure, exceeded");
    field("overlap_between_sessions", self.overlap_between_sessions, Range{0.0, 1.0}, "",
          "the same between sessions");
    field("skipped_maps", self.skipped_maps, Range{0, 1000}, "",
          "maps just before the query that are no reference closures");
    field("align_references", self.align_references, OnOff{}, "",
          "ICP between reference maps first, where ground truth differs between visits");
    field("min_inliers", self.min_inliers, Range{1, 1000}, "",
          "of the detector's closures whose precision and recall are given apart");
    field("aligned_m", self.aligned_m, Range{0.01, 100.0}, "m", "error of a pose taken as right");
    field("aligned_deg", self.aligned_deg, Range{0.01, 180.0}, "deg", "the same in rotation");
  }
};

/// A local map as ground truth has it.
struct EvaluatedMap {
  MapKey key;
  Pose T_world_map;                        ///< ground truth of its first scan
  Points points;                           ///< rebuilt at ground-truth poses, in the map's frame
  std::vector<Eigen::Vector3d> positions;  ///< ground truth of its scans, in the world
};

/// A row of closures.csv.
struct ReportedClosure {
  MapKey reference, query;
  bool detector = true;   ///< else found from the solution
  bool accepted = false;  ///< in the final graph
  int inliers = 0;
  Pose T_query_reference, initial_T_query_reference;
};

/// How the way of the query runs where it meets that of the reference.
enum class TravelDirection { same, opposite, crossing, apart };
[[nodiscard]] const char* to_string(TravelDirection direction);

struct ReferenceClosure {
  MapKey reference, query;
  double overlap = 0.0;
  TravelDirection direction = TravelDirection::apart;
  double distance = 0.0;  ///< m between the two ways where they meet (median)
  bool detected = false;  ///< by the detector, with at least min_inliers
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
  std::size_t misaligned = 0;     ///< of the true, those whose pose is wrong
  std::size_t below_overlap = 0;  ///< of the false, those whose pose is right all the same
  std::optional<double> precision, recall;
};

struct ClosureEvaluation {
  std::vector<ReferenceClosure> references;
  PrecisionRecall detector;  ///< over the inliers of detector closures
  DetectionCounts
      detector_accepted;        ///< detector closures with at least min_inliers, initial poses
  DetectionCounts final_graph;  ///< accepted closures of either source, refined poses
  /// Of true closures with at least min_inliers, and of those in the final graph. The proxy is
  /// point-to-point ICP of the session's own maps started at ground truth.
  PoseErrors initial_to_proxy, initial_absolute, refined_to_proxy, refined_absolute;
  /// Root mean square of overlap at the initial pose less overlap of the reference maps, over true
  /// detector closures with at least five inliers (Tables 5 and 8).
  std::optional<double> overlap_rmse;
  std::size_t overlap_closures = 0;
};

/// `load_map` gives the session's own points of a map. Closures between maps that are not among
/// `maps` are an error (InputError).
[[nodiscard]] ClosureEvaluation evaluate_closures(
    const std::vector<EvaluatedMap>& maps, const std::vector<ReportedClosure>& closures,
    const std::function<Points(const MapKey&)>& load_map, const ClosureEvaluationOptions& options,
    const Progress& progress = {});

}  // namespace groundloop
