#include "frontend/recordings/ground_truth.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "frontend/core/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::recordings {
namespace {

using groundloop::testing::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Property;

NumberTable numbers(const TemporaryFolder& folder, const std::string& text) {
  std::ofstream(folder / "table.csv") << text;
  return read_numbers(folder / "table.csv");
}

TEST(ReadNumbers, ALineOfWordsBeforeTheFirstRowIsAHeading) {
  const TemporaryFolder folder;
  const NumberTable table = numbers(folder, "# made by hand\n\ntime,x,y\n1,2,3\n4,5,6\n");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[1], (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(table.lines[1], 5U);
}

// A first row whose comma is missing was taken for a heading, and its pose was gone.
TEST(ReadNumbers, AFirstRowThatIsBrokenIsNoHeading) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { (void)numbers(folder, "1700000000-0.67,2,3\n4,5,6\n"); },
              ::testing::Throws<InputError>(
                  Property(&InputError::what, HasSubstr("table.csv:1: '1700000000-0.67'"))));
}

}  // namespace
}  // namespace groundloop::recordings
