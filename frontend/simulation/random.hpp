// Random numbers that are a function of what they are for: a key made of seeds, ids and counters
// goes in, the same number comes out on every run and for every order of calls (SplitMix64,
// Steele et al. 2014). Not for cryptography, and normal deviates end at 4.9 sigma.
#pragma once

#include <cstdint>

namespace groundloop::simulation {

/// A 64-bit mixing of its argument in which every input bit reaches every output bit.
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// One key from several integers; their order matters.
template <typename... Keys>
constexpr std::uint64_t key_of(std::uint64_t first, Keys... rest) {
  std::uint64_t key = mix(first);
  ((key = mix(key ^ static_cast<std::uint64_t>(rest))), ...);
  return key;
}

/// In [0, 1), with 53 random bits.
constexpr double unit(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; }

/// Of mean 0 and variance 1: the sum of eight 16-bit uniforms, in fixed arithmetic.
constexpr double normal(std::uint64_t bits) {
  std::int64_t sum = 0;
  for (const std::uint64_t word : {bits, mix(bits)}) {
    for (int i = 0; i < 4; ++i) sum += static_cast<std::int64_t>((word >> (16 * i)) & 0xffffU);
  }
  // Eight uniforms on 0..65535: mean 4 * 65535, variance 8 * (65536^2 - 1) / 12.
  return (static_cast<double>(sum) - 262140.0) * (1.0 / 53509.91992145008);
}

/// A sequence of numbers that belongs to one key.
class Random {
 public:
  explicit constexpr Random(std::uint64_t key) : key_(key) {}

  constexpr std::uint64_t bits() { return mix(key_ + 0x9e3779b97f4a7c15ULL * ++count_); }
  constexpr double uniform() { return unit(bits()); }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  constexpr double gauss(double sigma) { return sigma * normal(bits()); }
  constexpr bool chance(double probability) { return uniform() < probability; }
  /// In [0, n).
  constexpr int below(int n) { return static_cast<int>(uniform() * n); }

 private:
  std::uint64_t key_;
  std::uint64_t count_ = 0;
};

}  // namespace groundloop::simulation
