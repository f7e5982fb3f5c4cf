// The end of a run or a merge at the terminal.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/commands/commands.hpp"

namespace groundloop::apps {

/// Prints the closing table to standard error, unless quiet.
void print_closing_table(const nlohmann::ordered_json& metrics, const std::filesystem::path& folder,
                         const Context& context);

}  // namespace groundloop::apps
