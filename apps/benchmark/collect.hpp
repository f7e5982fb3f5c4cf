// Reads what the steps of a suite left and makes its results of it.
#pragma once

#include "apps/benchmark/results.hpp"
#include "apps/benchmark/steps.hpp"

namespace groundloop::apps {

/// A source whose step is not done becomes a gap. Throws InputError where a document is damaged.
[[nodiscard]] Results collect_results(const Suite& suite, const SuitePlan& plan,
                                      const std::filesystem::path& out);

}  // namespace groundloop::apps
