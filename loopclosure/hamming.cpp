#include "loopclosure/hamming.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace groundloop {
namespace {

// Stored descriptors may lie anywhere in memory; those a few steps ahead are fetched meanwhile.
constexpr std::size_t kAhead = 8;

inline void prefetch(const Descriptor* stored, const std::uint32_t* ids, std::size_t i,
                     std::size_t count) {
  if (ids != nullptr && i + kAhead < count) __builtin_prefetch(&stored[ids[i + kAhead]]);
}

inline const Descriptor& pick(const Descriptor* stored, const std::uint32_t* ids, std::size_t i) {
  return stored[ids == nullptr ? i : ids[i]];
}

void distances_portable(const Descriptor& query, const Descriptor* stored, const std::uint32_t* ids,
                        std::size_t count, std::uint16_t* distances) {
  for (std::size_t i = 0; i < count; ++i) {
    prefetch(stored, ids, i, count);
    distances[i] = static_cast<std::uint16_t>(hamming_distance(query, pick(stored, ids, i)));
  }
}

#if defined(__x86_64__)

__attribute__((target("popcnt"))) void distances_popcnt(const Descriptor& query,
                                                        const Descriptor* stored,
                                                        const std::uint32_t* ids, std::size_t count,
                                                        std::uint16_t* distances) {
  for (std::size_t i = 0; i < count; ++i) {
    prefetch(stored, ids, i, count);
    const Descriptor& d = pick(stored, ids, i);
    const long long bits = _mm_popcnt_u64(query[0] ^ d[0]) + _mm_popcnt_u64(query[1] ^ d[1]) +
                           _mm_popcnt_u64(query[2] ^ d[2]) + _mm_popcnt_u64(query[3] ^ d[3]);
    distances[i] = static_cast<std::uint16_t>(bits);
  }
}

// One 256-bit register a descriptor: nibbles counted by table look-up, summed to 64-bit lanes.
__attribute__((target("avx2"))) void distances_avx2(const Descriptor& query,
                                                    const Descriptor* stored,
                                                    const std::uint32_t* ids, std::size_t count,
                                                    std::uint16_t* distances) {
  const __m256i table = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2,
                                         1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low = _mm256_set1_epi8(0x0f);
  const __m256i q = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(query.data()));
  for (std::size_t i = 0; i < count; ++i) {
    prefetch(stored, ids, i, count);
    const Descriptor& d = pick(stored, ids, i);
    const __m256i x =
        _mm256_xor_si256(q, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(d.data())));
    const __m256i bytes =
        _mm256_add_epi8(_mm256_shuffle_epi8(table, _mm256_and_si256(x, low)),
                        _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi16(x, 4), low)));
    const __m256i sums = _mm256_sad_epu8(bytes, _mm256_setzero_si256());
    const __m128i halves =
        _mm_add_epi64(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
    distances[i] =
        static_cast<std::uint16_t>(_mm_cvtsi128_si32(halves) + _mm_extract_epi16(halves, 4));
  }
}

__attribute__((target("avx512f,avx512vl,avx512vpopcntdq"))) void distances_avx512(
    const Descriptor& query, const Descriptor* stored, const std::uint32_t* ids, std::size_t count,
    std::uint16_t* distances) {
  const __m256i q = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(query.data()));
  const auto counts = [&](std::size_t i)
      __attribute__((target("avx512f,avx512vl,avx512vpopcntdq"), always_inline)) {
    prefetch(stored, ids, i, count);
    const Descriptor& d = pick(stored, ids, i);
    return _mm256_popcnt_epi64(
        _mm256_xor_si256(q, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(d.data()))));
  };
  std::size_t i = 0;
  // Four descriptors share their sums: lanes are interleaved, added, and added across halves.
  for (; i + 4 <= count; i += 4) {
    const __m256i a = counts(i), b = counts(i + 1), c = counts(i + 2), d = counts(i + 3);
    const __m256i ab = _mm256_add_epi64(_mm256_unpacklo_epi64(a, b), _mm256_unpackhi_epi64(a, b));
    const __m256i cd = _mm256_add_epi64(_mm256_unpacklo_epi64(c, d), _mm256_unpackhi_epi64(c, d));
    const __m256i sums = _mm256_add_epi64(_mm256_permute2x128_si256(ab, cd, 0x20),
                                          _mm256_permute2x128_si256(ab, cd, 0x31));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(distances + i), _mm256_cvtepi64_epi16(sums));
  }
  for (; i < count; ++i) {
    const __m256i sums = counts(i);
    const __m128i halves =
        _mm_add_epi64(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
    distances[i] = static_cast<std::uint16_t>(
        _mm_cvtsi128_si64(halves) + _mm_cvtsi128_si64(_mm_unpackhi_epi64(halves, halves)));
  }
}

#endif

}  // namespace

std::vector<HammingKernel> hamming_kernels() {
  std::vector<HammingKernel> kernels{{"portable", distances_portable}};
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("popcnt")) kernels.push_back({"popcnt", distances_popcnt});
  if (__builtin_cpu_supports("avx2")) kernels.push_back({"avx2", distances_avx2});
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vpopcntdq")) {
    kernels.push_back({"avx512", distances_avx512});
  }
#endif
  return kernels;
}

void hamming_distances(const Descriptor& query, const Descriptor* stored, std::size_t count,
                       std::uint16_t* distances) {
  hamming_distances_at(query, stored, nullptr, count, distances);
}

void hamming_distances_at(const Descriptor& query, const Descriptor* stored,
                          const std::uint32_t* ids, std::size_t count, std::uint16_t* distances) {
  static const auto best = hamming_kernels().back().distances;
  best(query, stored, ids, count, distances);
}

}  // namespace groundloop
