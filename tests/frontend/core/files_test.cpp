#include "frontend/core/files.hpp"

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

TEST(Files, SecondsAreReadToTheNanosecond) {
  std::int64_t ns = 0;
  ASSERT_TRUE(parse_seconds("1317354879.123456789", ns));
  EXPECT_EQ(ns, 1317354879123456789);
  ASSERT_TRUE(parse_seconds("-0.5", ns));
  EXPECT_EQ(ns, -500000000);
  ASSERT_TRUE(parse_seconds("2.073381e-01", ns));
  EXPECT_EQ(ns, 207338100);
  ASSERT_TRUE(parse_seconds("12", ns));
  EXPECT_EQ(ns, 12000000000);
  EXPECT_FALSE(parse_seconds("nan", ns));
  EXPECT_FALSE(parse_seconds("", ns));
  EXPECT_FALSE(parse_seconds(".", ns));
  EXPECT_FALSE(parse_seconds("1.2.3", ns));
  EXPECT_FALSE(parse_seconds("12x", ns));
}

TEST(Files, SecondsArePrintedWithNineDecimals) {
  EXPECT_EQ(seconds_text(1317354879123456789), "1317354879.123456789");
  EXPECT_EQ(seconds_text(-500000000), "-0.500000000");
  EXPECT_EQ(seconds_text(7), "0.000000007");
}

TEST(Files, NumbersInNamesCompareAsNumbers) {
  EXPECT_TRUE(natural_less("9.bin", "10.bin"));
  EXPECT_TRUE(natural_less("a9b2", "a9b10"));
  EXPECT_TRUE(natural_less("009.bin", "10.bin"));
  EXPECT_FALSE(natural_less("10.bin", "9.bin"));
  EXPECT_FALSE(natural_less("a", "a"));
}

TEST(Files, AMissingFileIsNamed) {
  try {
    (void)read_file("/nonexistent/file.bin");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("/nonexistent/file.bin"), std::string::npos);
  }
}

}  // namespace
}  // namespace groundloop
