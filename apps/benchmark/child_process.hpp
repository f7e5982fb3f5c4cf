// A program run beside this one: its output into files, its processor time and memory measured.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace groundloop::apps {

struct ProcessEnd {
  int exit_code = 0;  ///< 128 + signal where a signal ended it
  double seconds = 0.0, processor_seconds = 0.0, peak_memory_mb = 0.0;
};

class ChildProcess {
 public:
  /// Starts `command`; standard output and error go to files, which may be the same. Throws
  /// InputError where the program cannot be started.
  ChildProcess(const std::vector<std::string>& command,
               const std::filesystem::path& standard_output,
               const std::filesystem::path& standard_error);
  /// Stops it (SIGTERM) and waits, where it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// How it ended, once it has. Does not wait.
  [[nodiscard]] std::optional<ProcessEnd> ended();

 private:
  pid_t pid_ = 0;
  double start_ = 0.0;
  std::optional<ProcessEnd> end_;
};

}  // namespace groundloop::apps
