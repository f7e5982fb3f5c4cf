// What a run or a merge ends with at the terminal: what was found, how good it is, what it took,
// where it lies, and what to do next. Made from metrics.json alone.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace groundloop::apps {

/// `folder` as it was named on the command line, since its commands are for copying.
[[nodiscard]] std::string closing_table(const nlohmann::ordered_json& metrics,
                                        const std::filesystem::path& folder, std::size_t width,
                                        bool coloured);

}  // namespace groundloop::apps
