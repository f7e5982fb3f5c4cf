#include "apps/commands/progress_bar.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <deque>
#include <memory>

#include <unistd.h>

#include "apps/cli/terminal.hpp"
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

// One line that is drawn anew. The rate is that of the last seconds: stages do not run evenly, and
// what is left will go as the work goes now.
class Bar {
 public:
  void draw(const std::string& stage, std::size_t done, std::size_t total) {
    const auto now = Clock::now();
    if (stage != stage_) {
      end_progress();
      stage_ = stage;
      marks_ = {{now, done}};
    } else if (now - drawn_ < std::chrono::milliseconds(100) && done < total) {
      return;
    }
    drawn_ = now;
    const std::string line =
        progress_line(stage, done, total, rate(now, done),
                      static_cast<std::size_t>(terminal_columns(STDERR_FILENO)) - 1);
    std::fprintf(stderr, "\r%s\033[K", line.c_str());
    std::fflush(stderr);
    line_open = true;
  }

 private:
  struct Mark {
    Clock::time_point time;
    std::size_t done = 0;
  };
  // Per second, over the last ten seconds at least once they have passed.
  double rate(Clock::time_point now, std::size_t done) {
    constexpr auto kSpan = std::chrono::seconds(10);
    if (now - marks_.back().time >= std::chrono::seconds(1)) marks_.push_back({now, done});
    while (marks_.size() > 2 && now - marks_[1].time >= kSpan) marks_.pop_front();
    const double seconds = std::chrono::duration<double>(now - marks_.front().time).count();
    return seconds > 0.0 ? static_cast<double>(done - marks_.front().done) / seconds : 0.0;
  }

  std::string stage_;
  std::deque<Mark> marks_;
  Clock::time_point drawn_;
};

}  // namespace

std::string progress_line(const std::string& stage, std::size_t done, std::size_t total,
                          double rate, std::size_t width) {
  constexpr std::size_t kBar = 30;
  std::string figures = total > 0  ? std::to_string(done) + "/" + std::to_string(total)
                        : done > 0 ? std::to_string(done)
                                   : "...";
  if (rate > 0.0) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "  %.1f/s", rate);
    figures += buffer;
    if (total > done)
      figures += "  " + clock_text(static_cast<double>(total - done) / rate) + " left";
  }
  std::string bar;
  if (total > 0 && stage.size() + figures.size() + kBar + 4 <= width) {
    const std::size_t full = kBar * std::min(done, total) / total;
    bar = "[" + std::string(full, '=') + std::string(kBar - full, ' ') + "] ";
  }
  return (stage + " " + bar + figures).substr(0, width);
}

Progress make_progress(const Context& context) {
  const bool draws = !context.quiet && draws_anew(STDERR_FILENO);
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
