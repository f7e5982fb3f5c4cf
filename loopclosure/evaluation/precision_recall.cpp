#include "loopclosure/evaluation/precision_recall.hpp"

#include <algorithm>

namespace groundloop {

PrecisionRecall precision_recall(std::vector<ScoredClosure> closures, std::size_t references) {
  PrecisionRecall result;
  result.references = references;
  std::sort(closures.begin(), closures.end(),
            [](const ScoredClosure& a, const ScoredClosure& b) { return a.score > b.score; });
  std::size_t correct = 0, wrong = 0;
  for (std::size_t i = 0; i < closures.size(); ++i) {
    (closures[i].correct ? correct : wrong) += 1;
    if (i + 1 < closures.size() && closures[i + 1].score == closures[i].score) continue;
    PrecisionRecallPoint point;
    point.threshold = closures[i].score;
    point.true_positives = correct;
    point.false_positives = wrong;
    point.precision = static_cast<double>(correct) / static_cast<double>(correct + wrong);
    if (references > 0)
      point.recall = static_cast<double>(correct) / static_cast<double>(references);
    if (correct > 0) {
      point.f1 = 2 * point.precision * point.recall / (point.precision + point.recall);
    }
    result.curve.push_back(point);
  }
  if (references == 0) return result;
  double average = 0.0, f1 = 0.0, recall = 0.0;
  for (const PrecisionRecallPoint& point : result.curve) {
    average += (point.recall - recall) * point.precision;
    recall = point.recall;
    f1 = std::max(f1, point.f1);
    if (point.false_positives == 0) result.recall_at_full_precision = point.recall;
  }
  result.average_precision = average;
  result.max_f1 = f1;
  return result;
}

}  // namespace groundloop
