// The scale of odometry's registration, from how far predictions were off of late (KISS-ICP, Vizzo
// et al., RA-L 2023, Sec. III-C). Unlike there the mean forgets: one bad step, or an hour of them,
// does not widen the scale for the rest of a recording.
#pragma once

#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>

#include "frontend/core/binary_io.hpp"

namespace groundloop {

class AdaptiveThreshold {
 public:
  /// `initial`: the scale before any motion was seen, m; `min_motion`: smaller deviations do not
  /// count, m.
  AdaptiveThreshold(double initial, double min_motion)
      : min_motion_(min_motion), mean_square_(initial * initial) {}

  [[nodiscard]] double value() const { return std::sqrt(mean_square_); }

  /// A scan was found so far from its prediction, m.
  void learn(double deviation) {
    if (!(deviation > min_motion_)) return;
    ++count_;
    mean_square_ += (deviation * deviation - mean_square_) / std::min(count_, kMemory);
  }

  void save(std::ostream& out) const {
    put(out, mean_square_);
    put(out, count_);
  }
  void load(std::istream& in) {
    get(in, mean_square_);
    get(in, count_);
  }

 private:
  // Deviations that the mean goes back over.
  static constexpr double kMemory = 100.0;
  double min_motion_;
  double mean_square_;  // m^2
  double count_ = 1.0;
};

}  // namespace groundloop
