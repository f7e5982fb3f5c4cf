#include "frontend/core/checksum.hpp"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

// XXH3's published value of nothing at all.
TEST(Checksum, OfNothingIsTheOneOfXxh3) { EXPECT_EQ(hex(checksum("")), "2d06800538d394c2"); }

TEST(Checksum, PieceByPieceIsTheSameAsWhole) {
  std::string text(3'000'000, '\0');
  std::iota(text.begin(), text.end(), 'a');
  Checksum pieces;
  for (std::size_t at = 0, step = 1; at < text.size(); at += step, step = step * 2 % 99'991 + 1)
    pieces.add(std::string_view(text).substr(at, step));
  EXPECT_EQ(pieces.value(), checksum(text));
  const testing::TemporaryFolder folder;
  write_text_atomically(folder / "file", text);
  EXPECT_EQ(checksum_of_file(folder / "file"), checksum(text));
}

}  // namespace
}  // namespace groundloop
