// Precision and recall of closures over a threshold on their inliers (Sec. 4.5 of the paper): the
// curve, average precision, recall at full precision, and the greatest F1 score.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace groundloop {

/// A reported closure and whether its pair of maps is a reference closure.
struct ScoredClosure {
  double score = 0.0;
  bool correct = false;
};

/// Figures of all closures with a score of at least `threshold`.
struct PrecisionRecallPoint {
  double threshold = 0.0;
  std::size_t true_positives = 0, false_positives = 0;
  double precision = 0.0, recall = 0.0, f1 = 0.0;
};

struct PrecisionRecall {
  std::size_t references = 0;               ///< reference closures
  std::vector<PrecisionRecallPoint> curve;  ///< one point a distinct score, highest first
  /// Sum over the curve of (step of recall) times precision; ties in the score count together.
  /// Empty where there are no reference closures; 0 where none was found.
  std::optional<double> average_precision;
  /// Greatest recall of a point of precision 1. Empty where there is no such point.
  std::optional<double> recall_at_full_precision;
  std::optional<double> max_f1;
};

[[nodiscard]] PrecisionRecall precision_recall(std::vector<ScoredClosure> closures,
                                               std::size_t references);

}  // namespace groundloop
