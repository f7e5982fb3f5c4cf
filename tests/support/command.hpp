// Runs the command line in this process, as a shell would.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "apps/commands/commands.hpp"

namespace groundloop::testing {

struct CommandResult {
  int exit_code = 0;
  std::string standard_output, standard_error;
};

inline CommandResult run_command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "groundloop");
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  CommandResult result;
  result.exit_code = apps::run_command_line(static_cast<int>(argv.size()), argv.data());
  result.standard_output = ::testing::internal::GetCapturedStdout();
  result.standard_error = ::testing::internal::GetCapturedStderr();
  return result;
}

/// Expects exit code 2 and one line on standard error that names every one of `parts`.
inline void expect_input_error(const CommandResult& result, const std::vector<std::string>& parts) {
  EXPECT_EQ(result.exit_code, 2) << result.standard_error;
  std::string last;
  std::size_t start = 0;
  while (start < result.standard_error.size()) {
    const std::size_t end =
        std::min(result.standard_error.find('\n', start), result.standard_error.size());
    last = result.standard_error.substr(start, end - start);
    start = end + 1;
  }
  EXPECT_EQ(last.rfind("groundloop: ", 0), 0U) << result.standard_error;
  for (const std::string& part : parts)
    EXPECT_NE(last.find(part), std::string::npos) << last << "\nlacks " << part;
}

}  // namespace groundloop::testing
