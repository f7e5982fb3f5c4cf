#include "apps/benchmark/child_process.hpp"

#include <chrono>
#include <cstring>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "frontend/core/error.hpp"

extern char** environ;

namespace groundloop::apps {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command,
                           const std::filesystem::path& standard_output,
                           const std::filesystem::path& standard_error) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 2, standard_error.c_str(), kWrite, 0644);
  if (standard_output == standard_error) {
    posix_spawn_file_actions_adddup2(&files, 2, 1);
  } else {
    posix_spawn_file_actions_addopen(&files, 1, standard_output.c_str(), kWrite, 0644);
  }
  start_ = now();
  const int error =
      posix_spawnp(&pid_, command.front().c_str(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    pid_ = 0;
    throw InputError(command.front() + ": cannot be started: " + std::strerror(error));
  }
}

ChildProcess::~ChildProcess() {
  if (pid_ == 0 || end_) return;
  kill(pid_, SIGTERM);
  int status = 0;
  waitpid(pid_, &status, 0);
}

std::optional<ProcessEnd> ChildProcess::ended() {
  if (end_) return end_;
  int status = 0;
  rusage usage{};
  if (wait4(pid_, &status, WNOHANG, &usage) != pid_) return std::nullopt;
  ProcessEnd end;
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  end.seconds = now() - start_;
  end.processor_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  end.peak_memory_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  end_ = end;
  return end_;
}

}  // namespace groundloop::apps
