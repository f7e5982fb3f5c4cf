#include "apps/benchmark/table.hpp"

#include <gtest/gtest.h>

#include "apps/benchmark/suite_tables.hpp"

namespace groundloop::apps {
namespace {

Table example() {
  Table table;
  table.title = "Closures_1";
  table.notes = {"AP: 50 % of all"};
  table.columns = {{"town", "group", "", false}, {"AP", "ap", "A & B", true}};
  table.rows = {{{"spin16, car", {}, {}, 0, false}, {"", 0.75, 0.0625, 3, true}},
                {{"raster", {}, {}, 0, false}, {"", {}, {}, 3, false}}};
  return table;
}

TEST(Table, IsWrittenAsMarkdown) {
  EXPECT_EQ(to_markdown(example()),
            "## Closures_1\n\n"
            "| town | A & B: AP |\n"
            "| --- | ---: |\n"
            "| spin16, car | **0.750 ± 0.062** |\n"
            "| raster | - |\n\n"
            "- AP: 50 % of all\n");
}

TEST(Table, IsWrittenAsCsvWithAllDigits) {
  EXPECT_EQ(to_csv(example()),
            "group,A & B: ap,A & B: ap_error\n"
            "\"spin16, car\",0.75,0.0625\n"
            "raster,,\n");
}

TEST(Table, IsWrittenAsLatex) {
  EXPECT_EQ(to_latex(example()),
            "% needs booktabs\n\\begin{table*}\n\\caption{Closures\\_1. AP: 50 \\% of all.}\n"
            "\\centering\n\\begin{tabular}{lr}\n\\toprule\n"
            "\\multicolumn{1}{c}{} & \\multicolumn{1}{c}{A \\& B} \\\\\n"
            "\\cmidrule(lr){2-2}\n"
            "town & AP \\\\\n\\midrule\n"
            "spin16, car & \\textbf{0.750} $\\pm$ 0.062 \\\\\n"
            "raster & - \\\\\n\\bottomrule\n\\end{tabular}\n\\end{table*}\n");
}

Result result(const std::string& group, const std::string& subject,
              const std::string& configuration, double ape) {
  Result r;
  r.kind = "recording";
  r.group = group;
  r.subject = subject;
  r.configuration = configuration;
  r.references = "truth";
  r.figures["ape"] = ape;
  return r;
}

SuiteTable ape_table() {
  SuiteTable wanted;
  wanted.title = "APE";
  wanted.kind = "trajectory";
  wanted.columns = {"ape"};
  return wanted;
}

TEST(MakeTable, PutsConfigurationsOfAGroupTogetherAndMarksTheBest) {
  Results results;
  results.results = {result("town", "a", "x", 1.0), result("town", "b", "x", 3.0),
                     result("park", "c", "x", 9.0), result("town", "a", "y", 0.5)};
  const Table table = make_table(ape_table(), results);
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[0][0].text, "town");
  EXPECT_EQ(table.rows[0][1].text, "x");
  EXPECT_DOUBLE_EQ(table.rows[0][2].value.value(), 2.0);
  EXPECT_DOUBLE_EQ(table.rows[0][3].value.value(), 2.0);
  EXPECT_FALSE(table.rows[0][3].best);
  EXPECT_TRUE(table.rows[1][3].best);
  EXPECT_EQ(table.rows[2][0].text, "park");
}

TEST(MakeTable, PutsGroupsSideBySideInTheOrderWanted) {
  Results results;
  results.results = {result("town", "a", "x", 1.0), result("park", "c", "y", 9.0)};
  SuiteTable wanted = ape_table();
  wanted.groups_across = true;
  wanted.groups = {"park", "town"};
  const Table table = make_table(wanted, results);
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(table.columns[1].above, "park");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(to_text(table.rows[0][1]), "9.000");
  EXPECT_EQ(to_text(table.rows[0][2]), "-");
}

TEST(CompareResults, SaysWhatChangedByMoreThanItsError) {
  Results before, after;
  before.results = {result("town", "a", "x", 1.0), result("town", "b", "x", 3.0)};
  after.results = {result("town", "a", "x", 0.5), result("town", "b", "x", 2.4)};
  const std::vector<Table> tables = compare_results(before, after);
  ASSERT_EQ(tables.size(), 1U);
  ASSERT_EQ(tables[0].rows.size(), 1U);
  EXPECT_NEAR(tables[0].rows[0][6].value.value(), -0.55, 1e-12);
  EXPECT_NEAR(tables[0].rows[0][6].error.value(), 0.05, 1e-12);
  EXPECT_EQ(tables[0].rows[0][7].text, "better");
}

}  // namespace
}  // namespace groundloop::apps
