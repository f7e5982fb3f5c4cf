#include "tests/fuzz/mutation.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace groundloop::fuzz {

namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2654435761U + 1) {}
  std::size_t below(std::size_t n) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>((state_ >> 33U) % n);
  }

 private:
  std::uint64_t state_;
};

constexpr std::array<std::string_view, 16> kNumbers{
    "0",      "-1",  "4294967296", "18446744073709551615", "9223372036854775807",
    "1e308",  "nan", "inf",        "-9223372036854775808", "99999999999999999999",
    "1e-320", "",    "0x10",       "2147483648",           "-2147483649",
    "1e9"};

void replace_number(std::string& bytes, std::size_t at, Random& random) {
  constexpr std::string_view kDigits = "0123456789.+-";
  const std::size_t begin = bytes.find_first_of(kDigits, at);
  if (begin == std::string::npos) return;
  const std::size_t end = std::min(bytes.find_first_not_of(kDigits, begin), bytes.size());
  bytes.replace(begin, end - begin, kNumbers[random.below(kNumbers.size())]);
}

}  // namespace

std::string mutate(std::string bytes, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t change = 0, changes = 1 + random.below(4); change < changes; ++change) {
    if (bytes.empty()) return bytes;
    // Half of the changes fall on the front, where headers are.
    const std::size_t reach =
        random.below(2) == 0 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
    const std::size_t at = random.below(reach);
    switch (random.below(8)) {
      case 0:
        bytes[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, 1 + random.below(40)));
        break;
      case 4:
        bytes.erase(at, 1 + random.below(16));
        break;
      case 5:
        replace_number(bytes, at, random);
        break;
      case 6:
        bytes.insert(random.below(bytes.size()), bytes.substr(at, 1 + random.below(100)));
        break;
      default: {
        const char value = random.below(2) == 0 ? '\xff' : '\0';
        for (std::size_t i = at; i < std::min(at + 4, bytes.size()); ++i) bytes[i] = value;
      }
    }
  }
  return bytes;
}

}  // namespace groundloop::fuzz
