// Hamming distances of 256-bit descriptors, over vector registers where the processor has them. The
// kernel is chosen once, at run time; every kernel gives the same numbers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "loopclosure/loop_closure.hpp"

namespace groundloop {

[[nodiscard]] inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

/// Bit `index` (0 to 255) of a descriptor.
[[nodiscard]] inline bool descriptor_bit(const Descriptor& d, int index) {
  return ((d[static_cast<std::size_t>(index) / 64] >> (index % 64)) & 1U) != 0;
}

/// Distances of `query` to `count` stored descriptors, written to `distances`.
void hamming_distances(const Descriptor& query, const Descriptor* stored, std::size_t count,
                       std::uint16_t* distances);
/// The same to stored[ids[0]], stored[ids[1]], ...
void hamming_distances_at(const Descriptor& query, const Descriptor* stored,
                          const std::uint32_t* ids, std::size_t count, std::uint16_t* distances);

/// A way to compute them; "portable" always works. Null ids stand for 0, 1, 2, ...
struct HammingKernel {
  std::string_view name;
  void (*distances)(const Descriptor& query, const Descriptor* stored, const std::uint32_t* ids,
                    std::size_t count, std::uint16_t* distances);
};
/// The kernels this processor can run, slowest first; for tests and benchmarks.
[[nodiscard]] std::vector<HammingKernel> hamming_kernels();

}  // namespace groundloop
