// --help as a text that teaches: how the command is called, what it does, examples, arguments,
// options, and the files it leaves.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "apps/cli/command_page.hpp"

namespace groundloop::apps {

/// Of at most `width` columns; headings in bold type where `coloured`.
[[nodiscard]] std::string help_text(const CommandPage& page, std::size_t width, bool coloured);

/// "--out FOLDER", "SESSION...", as all three kinds of documents show an option.
[[nodiscard]] std::string option_label(const OptionPage& option);

/// The command with its arguments and required options: "groundloop run RECORDING... --out FOLDER".
[[nodiscard]] std::string usage_line(const CommandPage& page);

/// The description with limits, default and "required".
[[nodiscard]] std::string option_text(const OptionPage& option);

/// Writes help_text() for the terminal at hand.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter();

}  // namespace groundloop::apps
