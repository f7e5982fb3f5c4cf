// What PCD and PLY files go through once they are parsed, as the reader of folders does it.
#pragma once

#include "frontend/recordings/point_files.hpp"
#include "frontend/recordings/point_layout.hpp"
#include "frontend/recordings/point_times.hpp"
#include "tests/fuzz/pipeline.hpp"

namespace groundloop::fuzz {

inline void decode_table(const recordings::PointLayout& layout, std::span<const std::byte> data,
                         std::size_t count, Nanoseconds stamp) {
  const auto sample = recordings::sample_times(layout, data, count, stamp, "input");
  std::vector<recordings::TimeSample> samples;
  if (sample) samples.push_back(*sample);
  const auto times = recordings::judge_times(samples, {});
  if (times) FUZZ_PROMISE(!times->described().empty());
  const recordings::DecodeRequest request{times ? &*times : nullptr, AttributeSet::all(), nullptr};
  const Scan scan = recordings::decode_points(layout, data, count, stamp, request, "input");
  expect_sound(scan);
  FUZZ_PROMISE(scan.points.size() <= count);
}

}  // namespace groundloop::fuzz
