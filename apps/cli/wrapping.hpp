// Words into lines, and two columns side by side: what help and tables at the terminal share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace groundloop::apps {

/// Lines of at most `width` characters (more only where one word is longer); at least one line.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t width);

/// Columns that a UTF-8 text takes, counting every code point as one.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// `left` at an indent of two, `right` from column `column` on, wrapped to `width`; on a line of
/// its own where `left` reaches that far. Ends in a line break.
[[nodiscard]] std::string two_columns(std::string_view left, std::string_view right,
                                      std::size_t column, std::size_t width);

}  // namespace groundloop::apps
