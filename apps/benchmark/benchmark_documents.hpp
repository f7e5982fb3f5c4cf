// The files that a benchmark leaves beside its steps: results.json, tables/*.{md,csv,tex},
// curves/*.csv, report.md and report.html.
#pragma once

#include <filesystem>

#include "apps/benchmark/results.hpp"
#include "apps/benchmark/suite.hpp"

namespace groundloop::apps {

void write_benchmark_documents(const Suite& suite, const Results& results,
                               const std::filesystem::path& out);

/// Version, machine and date.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> made_by(
    const std::string& command_line);

}  // namespace groundloop::apps
