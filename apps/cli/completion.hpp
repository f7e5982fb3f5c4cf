// Completion scripts for bash, zsh and fish: commands, options, choices, files and folders.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/command_page.hpp"

namespace groundloop::apps {

/// `pages` as all_pages() gives them: the first is the program's.
[[nodiscard]] std::string bash_completion(const std::vector<CommandPage>& pages);
[[nodiscard]] std::string zsh_completion(const std::vector<CommandPage>& pages);
[[nodiscard]] std::string fish_completion(const std::vector<CommandPage>& pages);

}  // namespace groundloop::apps
