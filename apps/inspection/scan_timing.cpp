#include "apps/inspection/scan_timing.hpp"

#include <algorithm>
#include <cmath>

namespace groundloop::apps {

namespace {

constexpr double kGap = 1.75;    // median intervals
constexpr double kWithin = 0.9;  // of the intervals, for the jitter

double at_share(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace

ScanTiming measure_timing(const Recording& recording) {
  ScanTiming timing;
  if (recording.size() < 2) return timing;
  std::vector<double> steps;
  for (std::size_t i = 1; i < recording.size(); ++i)
    steps.push_back(1e-9 * static_cast<double>(recording.stamp(i) - recording.stamp(i - 1)));
  timing.duration_s =
      1e-9 * static_cast<double>(recording.stamp(recording.size() - 1) - recording.stamp(0));
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  timing.period_s = *middle;
  timing.rate_hz = timing.period_s > 0.0 ? 1.0 / timing.period_s : 0.0;
  timing.longest_s = *std::max_element(steps.begin(), steps.end());
  std::vector<double> off;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > kGap * timing.period_s) {
      const double scans = steps[i] / timing.period_s;
      const auto missing = static_cast<std::size_t>(std::max(1.0, std::round(scans) - 1.0));
      timing.gaps.push_back({i, steps[i], missing});
      timing.missing += missing;
    } else {
      off.push_back(std::abs(steps[i] - timing.period_s));
    }
  }
  if (!off.empty()) timing.jitter_s = at_share(off, kWithin);
  return timing;
}

}  // namespace groundloop::apps
