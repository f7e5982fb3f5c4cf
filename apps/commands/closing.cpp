#include "apps/commands/closing.hpp"

#include <algorithm>
#include <cstdio>

#include <unistd.h>

#include "apps/cli/closing_table.hpp"
#include "apps/cli/terminal.hpp"

namespace groundloop::apps {

void print_closing_table(const nlohmann::ordered_json& metrics, const std::filesystem::path& folder,
                         const Context& context) {
  if (context.quiet) return;
  constexpr int kWidest = 100;
  const auto width = static_cast<std::size_t>(std::min(kWidest, terminal_columns(STDERR_FILENO)));
  const std::string table = closing_table(metrics, folder, width, shows_colours(STDERR_FILENO));
  std::fputs(table.c_str(), stderr);
}

}  // namespace groundloop::apps
