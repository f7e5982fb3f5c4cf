// Parallel loops whose results do not depend on the number of threads: work is cut into blocks of a
// fixed size, and sums over blocks are taken in block order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace groundloop {

/// Limits the threads of every parallel loop until changed; 0 means all cores. Not to be called
/// inside a loop.
void set_thread_count(int threads);
[[nodiscard]] int thread_count();

/// Calls f(block, begin, end) for consecutive blocks of `block_size` elements of [0, n), in any
/// order.
template <typename F>
void for_each_block(std::size_t n, std::size_t block_size, F&& f) {
  const std::size_t blocks = (n + block_size - 1) / block_size;
  const auto run = [&](std::size_t block) {
    f(block, block * block_size, std::min(n, (block + 1) * block_size));
  };
  if (blocks <= 1) {
    if (blocks == 1) run(0);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t b = range.begin(); b != range.end(); ++b) run(b);
                    });
}

/// Calls f(i) for each i of [0, n), in any order, `block_size` at a time.
template <typename F>
void parallel_for(std::size_t n, std::size_t block_size, F&& f) {
  for_each_block(n, block_size, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) f(i);
  });
}

/// Sum of f(begin, end) over the blocks of [0, n), added in block order. T needs operator+=.
template <typename T, typename F>
[[nodiscard]] T ordered_sum(std::size_t n, std::size_t block_size, const T& zero, F&& f) {
  std::vector<T> partial((n + block_size - 1) / block_size, zero);
  for_each_block(n, block_size, [&](std::size_t block, std::size_t begin, std::size_t end) {
    partial[block] = f(begin, end);
  });
  T sum = zero;
  for (const T& p : partial) sum += p;
  return sum;
}

}  // namespace groundloop
