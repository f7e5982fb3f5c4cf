#include "loopclosure/evaluation/precision_recall.hpp"

#include <gtest/gtest.h>

namespace groundloop {
namespace {

TEST(PrecisionRecall, EqualsFiguresWorkedOutByHand) {
  // Four references; found in order of score: right, right, wrong, right (tied with a wrong one).
  const PrecisionRecall pr =
      precision_recall({{5, true}, {20, true}, {9, false}, {5, false}, {12, true}}, 4);
  ASSERT_EQ(pr.curve.size(), 4U);
  EXPECT_EQ(pr.curve[0].threshold, 20);
  EXPECT_DOUBLE_EQ(pr.curve[1].recall, 0.5);
  EXPECT_DOUBLE_EQ(pr.curve[1].precision, 1.0);
  EXPECT_DOUBLE_EQ(pr.curve[2].precision, 2.0 / 3);
  EXPECT_EQ(pr.curve[3].true_positives, 3U);
  EXPECT_EQ(pr.curve[3].false_positives, 2U);
  // 1/4 * 1 + 1/4 * 1 + 0 * 2/3 + 1/4 * 3/5
  EXPECT_DOUBLE_EQ(pr.average_precision.value(), 0.65);
  EXPECT_DOUBLE_EQ(pr.recall_at_full_precision.value(), 0.5);
  // Of 2/5, 2/3, 4/7, 2 * 0.6 * 0.75 / 1.35 = 2/3.
  EXPECT_DOUBLE_EQ(pr.max_f1.value(), 2.0 / 3);
}

TEST(PrecisionRecall, FindingNothingIsAFailureNotAPerfectPrecision) {
  const PrecisionRecall pr = precision_recall({}, 5);
  EXPECT_DOUBLE_EQ(pr.average_precision.value(), 0.0);
  EXPECT_DOUBLE_EQ(pr.max_f1.value(), 0.0);
  EXPECT_FALSE(pr.recall_at_full_precision.has_value());
}

TEST(PrecisionRecall, AFalseClosureOnTopLeavesNoRecallAtFullPrecision) {
  const PrecisionRecall pr = precision_recall({{9, false}, {8, true}}, 1);
  EXPECT_FALSE(pr.recall_at_full_precision.has_value());
  EXPECT_DOUBLE_EQ(pr.average_precision.value(), 0.5);
}

TEST(PrecisionRecall, WithoutReferencesNothingIsDefinedButTheCounts) {
  const PrecisionRecall pr = precision_recall({{9, false}}, 0);
  EXPECT_FALSE(pr.average_precision.has_value());
  EXPECT_FALSE(pr.max_f1.has_value());
  EXPECT_EQ(pr.curve.at(0).false_positives, 1U);
}

}  // namespace
}  // namespace groundloop
