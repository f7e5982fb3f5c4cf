// How evenly the scans of a recording follow each other, by their stamps.
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

/// An interval in which at least one scan is missing.
struct TimeGap {
  std::size_t after = 0;    ///< number of the scan before it
  double seconds = 0.0;     ///< from that scan to the next
  std::size_t missing = 0;  ///< scans that would fill it at the usual rate
};

struct ScanTiming {
  double duration_s = 0.0;
  double period_s = 0.0;  ///< median interval; 0 where there is one scan
  double rate_hz = 0.0;
  /// Nine tenths of the intervals that are no gaps lie within so much of the median.
  double jitter_s = 0.0;
  double longest_s = 0.0;  ///< interval
  std::vector<TimeGap> gaps;
  std::size_t missing = 0;  ///< in all gaps
};

/// Gaps are intervals longer than 1.75 median ones, as RecordingInfo::gaps counts them.
[[nodiscard]] ScanTiming measure_timing(const Recording& recording);

}  // namespace groundloop::apps
