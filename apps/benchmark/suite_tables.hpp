// The tables of a suite from its results, and the comparison of two sets of results row by row.
#pragma once

#include <vector>

#include "apps/benchmark/results.hpp"
#include "apps/benchmark/suite.hpp"
#include "apps/benchmark/table.hpp"

namespace groundloop::apps {

/// One table; without rows where nothing fits.
[[nodiscard]] Table make_table(const SuiteTable& wanted, const Results& results);

/// One table a kind of those in either: for each row and measure that both have, the figures before
/// and after, the difference with its standard error over the recordings that both have, and
/// whether it is more than twice that.
[[nodiscard]] std::vector<Table> compare_results(const Results& before, const Results& after);

}  // namespace groundloop::apps
