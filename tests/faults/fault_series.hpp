// One command run again and again, each time with another of its operations failing, or killed
// before it. What must hold after each is tested here; how many there were is printed.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/support/process.hpp"

namespace groundloop::testing {

/// A command whose output is `out`. Everything it changes lies below `root`.
struct FaultedCommand {
  std::string name;
  std::filesystem::path root;
  std::filesystem::path out;  ///< a folder or a file below root
  std::vector<std::string> arguments;
  /// The arguments that go on after a fault; those of the command where nothing is to be resumed.
  std::function<std::vector<std::string>()> again;
  /// Brings `root` to the state before the command.
  std::function<void()> reset;
  /// Checksums of what the command left, to be those of an undisturbed one.
  std::function<std::map<std::string, std::uint64_t>()> bytes;
};

struct SeriesCounts {
  int injected = 0, refused = 0, survived = 0, killed = 0;
};

/// Operations of each kind that the command does undisturbed; leaves its output.
[[nodiscard]] std::map<std::string, long> count_operations(const FaultedCommand& command);

/// Injects a fault into every `stride`-th operation of a kind. Expects of each run: exit code 0
/// (the fault cost nothing) or 2 with one line that says what happened, or the kill; no file that
/// is not whole under its final name; and of the run after it the bytes of an undisturbed one.
SeriesCounts run_series(const FaultedCommand& command, const std::string& kind, long operations,
                        const std::string& fault, long stride = 1);

}  // namespace groundloop::testing
