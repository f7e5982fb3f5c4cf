// The command as a process of its own, which may be signalled, starved or killed.
#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace groundloop::testing {

struct ProcessResult {
  int exit_code = -1;  ///< -1 where a signal ended it
  int signal = 0;
  std::string standard_error;
};

struct ProcessOptions {
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to this process's own
  /// Sends `signal` so long after the start, where it still runs.
  std::optional<std::chrono::milliseconds> signal_after;
  int signal = SIGKILL;
};

/// Runs `groundloop` with the arguments and waits for its end. Standard error goes through `log`,
/// a file that is overwritten.
inline ProcessResult run_process(const std::vector<std::string>& arguments,
                                 const std::filesystem::path& log,
                                 const ProcessOptions& options = {}) {
  const pid_t pid = fork();
  if (pid == 0) {
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(out, STDERR_FILENO);
    dup2(out, STDOUT_FILENO);
    for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
    std::vector<std::string> words{GROUNDLOOP_BINARY};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(argv.front(), argv.data());
    _exit(127);
  }
  int status = 0;
  if (options.signal_after) {
    const auto deadline = std::chrono::steady_clock::now() + *options.signal_after;
    while (waitpid(pid, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() >= deadline) {
        kill(pid, options.signal);
        waitpid(pid, &status, 0);
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  } else {
    waitpid(pid, &status, 0);
  }
  ProcessResult result;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  std::ifstream in(log, std::ios::binary);
  result.standard_error.assign(std::istreambuf_iterator<char>(in), {});
  return result;
}

}  // namespace groundloop::testing
