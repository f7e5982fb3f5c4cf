#include "apps/cli/terminal.hpp"

#include <algorithm>
#include <cstdlib>

#include <sys/ioctl.h>
#include <unistd.h>

namespace groundloop::apps {

bool draws_anew(int descriptor) {
  if (::isatty(descriptor) == 0) return false;
  const char* kind = std::getenv("TERM");
  return kind != nullptr && *kind != '\0' && std::string_view(kind) != "dumb";
}

bool shows_colours(int descriptor) {
  // Any value but the empty one counts, as no-color.org has it.
  const char* none = std::getenv("NO_COLOR");
  return (none == nullptr || *none == '\0') && draws_anew(descriptor);
}

int terminal_columns(int descriptor) {
  constexpr int kUsual = 80;
  constexpr int kLeast = 40;
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsual;
  return std::max<int>(kLeast, size.ws_col);
}

std::string bold(std::string_view text, bool coloured) {
  if (!coloured) return std::string(text);
  return "\033[1m" + std::string(text) + "\033[0m";
}

}  // namespace groundloop::apps
