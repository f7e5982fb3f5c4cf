// What PCD and PLY files go through once they are parsed, as the reader of folders does it.
#pragma once

#include "frontend/recordings/point_files.hpp"
#include "frontend/recordings/point_layout.hpp"
#include "tests/fuzz/pipeline.hpp"

namespace groundloop::fuzz {

inline void decode_table(const recordings::PointLayout& layout, std::span<const std::byte> data,
                         std::size_t count, Nanoseconds stamp) {
  constexpr Nanoseconds kPeriod = 100'000'000;
  const auto times = recordings::infer_time_model(layout, data, count, stamp, kPeriod);
  if (times) FUZZ_PROMISE(!times->described().empty());
  const Scan scan = recordings::decode_points(layout, data, count, stamp, times, "input");
  expect_sound(scan);
  FUZZ_PROMISE(scan.points.size() <= count);
}

}  // namespace groundloop::fuzz
