#include "frontend/core/pcd.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "frontend/core/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using ::testing::HasSubstr;
using ::testing::Property;
using testing::TemporaryFolder;

TEST(Pcd, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const Points points{{1, 2, 3}, {-4, 5e-7F, 6e8F}};
  write_pcd(folder / "map.pcd", points);
  EXPECT_EQ(read_pcd(folder / "map.pcd"), points);
}

// A session may come from anybody: what is no number goes no further.
TEST(Pcd, RefusesPointsThatAreNoNumbers) {
  const TemporaryFolder folder;
  for (const float broken :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    write_pcd(folder / "map.pcd", {{1, 2, 3}, {4, broken, 6}});
    EXPECT_THAT([&] { (void)read_pcd(folder / "map.pcd"); },
                ::testing::Throws<InputError>(
                    Property(&InputError::what, HasSubstr("map.pcd: point 1 is no number"))));
  }
}

}  // namespace
}  // namespace groundloop
