#include "apps/commands/progress_bar.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>

#include <unistd.h>

#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> stop_requested{false};
std::atomic<bool> line_open{false};

void on_signal(int) {
  // A second signal ends the program at once.
  if (stop_requested.exchange(true)) std::_Exit(130);
}

std::string clock_text(double seconds) {
  const auto s = std::lround(seconds);
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%ld:%02ld", s / 60, s % 60);
  return buffer;
}

class Bar {
 public:
  void draw(const std::string& stage, std::size_t done, std::size_t total) {
    const auto now = Clock::now();
    if (stage != stage_) {
      end_progress();
      stage_ = stage;
      first_ = done;
      start_ = drawn_ = now;
    } else if (now - drawn_ < std::chrono::milliseconds(100) && done < total) {
      return;
    }
    drawn_ = now;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double rate = seconds > 0.0 ? static_cast<double>(done - first_) / seconds : 0.0;
    std::string line = stage + " ";
    if (total > 0) {
      constexpr std::size_t kWidth = 30;
      const std::size_t full = kWidth * done / total;
      line += "[" + std::string(full, '=') + std::string(kWidth - full, ' ') + "] ";
      line += std::to_string(done) + "/" + std::to_string(total);
    } else {
      line += std::to_string(done);
    }
    if (rate > 0.0) {
      char buffer[64];
      std::snprintf(buffer, sizeof buffer, "  %.1f/s", rate);
      line += buffer;
      if (total > done)
        line += "  " + clock_text(static_cast<double>(total - done) / rate) + " left";
    }
    std::fprintf(stderr, "\r%s\033[K", line.c_str());
    std::fflush(stderr);
    line_open = true;
  }

 private:
  std::string stage_;
  std::size_t first_ = 0;
  Clock::time_point start_, drawn_;
};

}  // namespace

Progress make_progress(const Context& context) {
  const bool draws = !context.quiet && ::isatty(STDERR_FILENO) != 0;
  return [draws, bar = std::make_shared<Bar>()](const std::string& stage, std::size_t done,
                                                std::size_t total) {
    if (stop_requested) throw Interrupted();
    if (draws) bar->draw(stage, done, total);
  };
}

void end_progress() {
  if (line_open.exchange(false)) std::fprintf(stderr, "\n");
}

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A terminal that closes; nohup has it ignored, and so it stays.
  struct sigaction hang_up {};
  sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

}  // namespace groundloop::apps
