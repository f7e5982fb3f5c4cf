// What there is to say of one command, taken from the very objects that parse its words, with the
// guide's examples and files: --help, man pages and completion are made from this and from nothing
// else, so that they cannot disagree.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/cli/command_guide.hpp"

namespace groundloop::apps {

/// An option ("--out") or an argument ("RECORDING").
struct OptionPage {
  std::string name;
  ValueGuide value;  ///< empty name: a flag
  std::vector<std::string> choices;
  std::string limits;  ///< "[0 - 1024]" where a number is bounded
  std::string description;
  std::string fallback;  ///< the default, where it is known
  bool required = false;
  bool repeats = false;
};

struct CommandName {
  std::string name, summary;
};

struct CommandPage {
  std::string path;  ///< "groundloop evaluate map"
  std::string summary;
  std::vector<OptionPage> arguments;
  std::vector<OptionPage> options;     ///< its own
  std::vector<OptionPage> everywhere;  ///< of the commands above it
  std::vector<CommandName> commands;   ///< below it
  CommandGuide guide;

  /// The last word of the path.
  [[nodiscard]] std::string name() const { return path.substr(path.find_last_of(' ') + 1); }
};

[[nodiscard]] CommandPage page_of(const CLI::App& command);

/// The page of the command and of all below it, in the order in which they were added.
[[nodiscard]] std::vector<CommandPage> all_pages(const CLI::App& command);

}  // namespace groundloop::apps
