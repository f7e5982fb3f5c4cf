// Busy seconds of the calling thread between laps, for the times of stages: what else the machine
// does meanwhile does not count.
#pragma once

#include <ctime>

namespace groundloop {

class Stopwatch {
 public:
  /// Seconds since the last lap, or since the start.
  double lap() {
    const double now = thread_seconds();
    const double seconds = now - last_;
    last_ = now;
    return seconds;
  }

 private:
  static double thread_seconds() {
    std::timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double last_ = thread_seconds();
};

}  // namespace groundloop
