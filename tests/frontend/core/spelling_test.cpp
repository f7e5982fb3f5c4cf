#include "frontend/core/spelling.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

// The textbook example: three edits.
TEST(Spelling, DistanceIsThatOfLevenshtein) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("sitting", "kitten"), 3U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("same", "same"), 0U);
}

TEST(Spelling, SuggestsOnlyWhatIsNear) {
  const std::vector<std::string> known{"run", "merge", "inspect"};
  EXPECT_EQ(nearest_word("inspct", known), "inspect");
  EXPECT_EQ(suggestion("merg", known), "; did you mean 'merge'?");
  EXPECT_EQ(suggestion("frobnicate", known), "");
}

}  // namespace
}  // namespace groundloop
