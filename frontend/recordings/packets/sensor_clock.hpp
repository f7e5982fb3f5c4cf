// One line of time out of a sensor's clock: it may begin anew every hour, be set while it runs, or
// stand for another epoch than the recorder's.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>

#include "frontend/core/scan.hpp"

namespace groundloop::recordings {

class SensorClock {
 public:
  /// `period`: after which the clock begins anew; 0: never.
  explicit SensorClock(Nanoseconds period) : period_(period) {}

  /// Nanoseconds from the first reading to this one.
  Nanoseconds advance(Nanoseconds reading, Nanoseconds arrival) {
    if (first_) {
      first_ = false;
      first_reading_ = reading;
      first_arrival_ = arrival;
    } else {
      step_ = step(reading, arrival);
      elapsed_ += step_;
    }
    last_reading_ = reading;
    last_arrival_ = arrival;
    least_delay_ = std::min(least_delay_, arrival - elapsed_);
    return elapsed_;
  }
  [[nodiscard]] Nanoseconds last_step() const { return step_; }
  /// How often the clock jumped while the recorder's did not.
  [[nodiscard]] std::size_t times_set() const { return times_set_; }

  /// True where the first reading is of the recorder's clock: as near as packets travel.
  [[nodiscard]] bool is_synchronised() const { return std::llabs(lead()) < kSecond; }
  /// The stamp of the first reading by the better of both clocks.
  [[nodiscard]] Nanoseconds origin() const {
    return is_synchronised() ? first_arrival_ - lead() : least_delay_;
  }

 private:
  static constexpr Nanoseconds kSecond = 1'000'000'000;

  [[nodiscard]] Nanoseconds wrapped(Nanoseconds difference) const {
    if (period_ == 0) return difference;
    difference %= period_;
    if (difference > period_ / 2) difference -= period_;
    if (difference < -period_ / 2) difference += period_;
    return difference;
  }
  // How much later the first packet arrived than it was measured.
  [[nodiscard]] Nanoseconds lead() const { return wrapped(first_arrival_ - first_reading_); }

  Nanoseconds step(Nanoseconds reading, Nanoseconds arrival) {
    const Nanoseconds by_sensor = wrapped(reading - last_reading_);
    const Nanoseconds by_recorder = arrival - last_arrival_;
    const bool likely = by_sensor > -kSecond / 10 && by_sensor < kSecond;
    if (likely || std::llabs(by_sensor - by_recorder) < kSecond) return by_sensor;
    ++times_set_;
    return std::max<Nanoseconds>(by_recorder, 0);
  }

  Nanoseconds period_;
  bool first_ = true;
  Nanoseconds first_reading_ = 0, first_arrival_ = 0, last_reading_ = 0, last_arrival_ = 0;
  Nanoseconds elapsed_ = 0, step_ = 0;
  Nanoseconds least_delay_ = std::numeric_limits<Nanoseconds>::max();
  std::size_t times_set_ = 0;
};

}  // namespace groundloop::recordings
