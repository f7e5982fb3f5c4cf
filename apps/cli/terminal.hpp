// What may be done to the terminal behind a stream: colours only where someone looks, and not where
// NO_COLOR (no-color.org) asks for none.
#pragma once

#include <string>
#include <string_view>

namespace groundloop::apps {

/// Whether the file descriptor is a terminal that shows colours and bold type.
[[nodiscard]] bool shows_colours(int descriptor);

/// Whether lines on the file descriptor can be drawn anew: a terminal that is not "dumb".
[[nodiscard]] bool draws_anew(int descriptor);

/// Columns of the terminal, 80 where there is none; at least 40.
[[nodiscard]] int terminal_columns(int descriptor);

/// Bold type where `coloured`.
[[nodiscard]] std::string bold(std::string_view text, bool coloured);

}  // namespace groundloop::apps
