// The command as users call it, in this process: exit code 0 or 2, whatever its input is.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace groundloop::fuzz {

/// Runs `groundloop WORDS...` and returns whether it succeeded.
inline bool command(std::initializer_list<std::string> words) {
  std::vector<std::string> all{"groundloop", "--threads", "1", "--quiet"};
  all.insert(all.end(), words);
  std::vector<const char*> argv;
  for (const std::string& word : all) argv.push_back(word.c_str());
  const int code = apps::run_command_line(static_cast<int>(argv.size()), argv.data());
  FUZZ_PROMISE(code == 0 || code == 2);
  return code == 0;
}

}  // namespace groundloop::fuzz
