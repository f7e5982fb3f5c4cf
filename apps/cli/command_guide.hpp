// What cannot be read off a command's options: how it is used, what it leaves behind, and what the
// words after an option are. One table, from which --help, man pages and completion take it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace groundloop::apps {

struct Example {
  std::string command;  ///< a whole line for the shell
  std::string purpose;
};

struct WrittenFile {
  std::string name;
  std::string what;
};

struct CommandGuide {
  std::string about;  ///< a paragraph or none
  std::vector<Example> examples;
  std::vector<WrittenFile> files;  ///< that it writes; none: it only prints
};

/// Of the command whose words are `path`, "groundloop evaluate map"; empty where there is none.
[[nodiscard]] CommandGuide command_guide(std::string_view path);

/// What the shell offers for a word.
enum class Completes { nothing, file, folder };

struct ValueGuide {
  std::string name;  ///< "FOLDER"
  Completes completes = Completes::nothing;
};

/// Of the value after an option ("--out"), or of an argument ("SESSION"), of a command ("run").
[[nodiscard]] ValueGuide value_guide(std::string_view command, std::string_view option);

}  // namespace groundloop::apps
