#include "backend/session/table_row.hpp"

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

const std::filesystem::path kFile = "closures.csv";

std::string message(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(TableRow, SplitsAtCommasThatNoQuotesHold) {
  const TableRow row(kFile, 2, "1,\"a, \"\"b\"\"\",,-2.5\r");
  ASSERT_EQ(row.size(), 4u);
  EXPECT_EQ(row.integer<int>(0), 1);
  EXPECT_EQ(row.text(1), "a, \"b\"");
  EXPECT_EQ(row.optional_number(2), std::nullopt);
  EXPECT_EQ(row.number(3), -2.5);
}

TEST(TableRow, QuotedNamesComeBackAsTheyWere) {
  for (const std::string name : {"plain", "a,b", "\"", "a\"b,c\"", ""}) {
    const std::string text = quoted(name) + ",1";
    const TableRow row(kFile, 1, text);
    ASSERT_EQ(row.size(), 2u) << name;
    EXPECT_EQ(row.text(0), name);
  }
}

TEST(TableRow, PosesComeBackToTheLastBit) {
  const Pose pose(exp_so3({0.1, -2.0, 1.0 / 3.0}), {1e-17, 2.0 / 3.0, -12345.678901234567});
  std::string text = "7";
  append_pose(text, pose);
  const TableRow row(kFile, 1, text);
  ASSERT_EQ(row.size(), 8u);
  const Pose back = row.pose(1);
  EXPECT_EQ(back.translation, pose.translation);
  EXPECT_EQ(back.rotation.coeffs(), pose.rotation.coeffs());
}

TEST(TableRow, FaultsNameFileLineAndWhatIsWrong) {
  const TableRow row(kFile, 12, "1,1.5,nan,x,0,0,0,2");
  EXPECT_EQ(message([&] { row.expect_fields(9); }),
            "closures.csv:12: 8 fields, expected 9; run the session again");
  EXPECT_NE(message([&] { (void)row.integer<int>(1); }).find("closures.csv:12: '1.5' is no whole"),
            std::string::npos);
  EXPECT_NE(message([&] { (void)row.number(2); }).find("'nan' is no finite number"),
            std::string::npos);
  EXPECT_NE(message([&] { (void)row.optional_number(3); }).find("'x' is no finite number"),
            std::string::npos);
  const TableRow pose(kFile, 1, "0,0,0,0,0,0,2");
  EXPECT_NE(message([&] { (void)pose.pose(0); }).find("norm 2, expected 1"), std::string::npos);
  // 2^31 is no int.
  const TableRow large(kFile, 1, "2147483648");
  EXPECT_FALSE(message([&] { (void)large.integer<int>(0); }).empty());
  EXPECT_EQ(large.integer<std::int64_t>(0), 2147483648);
}

TEST(TableRow, RowsAreCountedFromTheFilesFirstLine) {
  std::vector<std::string> seen;
  for_each_row(kFile, "header\nfirst\n\nthird\r\nlast", 1, [&](const TableRow& row) {
    const std::string where = message([&] { row.fail("x"); });
    seen.push_back(where.substr(0, where.find(": ")) + " " + row.text(0));
  });
  EXPECT_EQ(seen, (std::vector<std::string>{"closures.csv:2 first", "closures.csv:4 third",
                                            "closures.csv:5 last"}));
}

}  // namespace
}  // namespace groundloop
