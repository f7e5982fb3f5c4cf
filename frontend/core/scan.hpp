// One sweep of a LiDAR, and the one time model of groundloop: an absolute stamp in nanoseconds and
// per-point offsets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/point_attributes.hpp"

namespace groundloop {

using Points = std::vector<Eigen::Vector3f>;

/// Nanoseconds since an epoch that the recording chooses; printed as seconds.
using Nanoseconds = std::int64_t;

/// Every reader refuses stamps farther than this (142 years) from their epoch, so that the
/// difference of any two of them, and a minute more, fits.
inline constexpr Nanoseconds kFarthestStamp = 4'500'000'000'000'000'000;
[[nodiscard]] inline bool is_stamp(Nanoseconds time) {
  return time >= -kFarthestStamp && time <= kFarthestStamp;
}

struct Scan {
  /// The instant the scan's pose refers to: the start of the scan unless the format says otherwise.
  Nanoseconds stamp = 0;
  /// Points in the scan frame, metres. No NaN, infinity or zero return: sources drop them with
  /// their times.
  Points points;
  /// Seconds from `stamp`, one a point; empty where the recording has no per-point times or needs
  /// no deskewing.
  std::vector<float> times;
  /// Those that were asked for (RecordingOptions::attributes) and that the recording has.
  PointAttributes attributes;
};

}  // namespace groundloop
