#include "frontend/recordings/lzf.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace groundloop::recordings {

namespace {
constexpr std::size_t kLongestLiteral = 32;
constexpr std::size_t kLongestMatch = 264;
constexpr std::size_t kFarthest = 8192;
constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
}  // namespace

bool lzf_decompress(std::span<const std::byte> in, std::span<std::byte> out) {
  std::size_t i = 0, o = 0;
  while (i < in.size()) {
    const auto control = std::to_integer<std::size_t>(in[i++]);
    if (control < kLongestLiteral) {
      const std::size_t length = control + 1;
      if (length > in.size() - i || length > out.size() - o) return false;
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(i), length,
                  out.begin() + static_cast<std::ptrdiff_t>(o));
      i += length;
      o += length;
      continue;
    }
    std::size_t length = control >> 5U;
    if (length == 7) {
      if (i >= in.size()) return false;
      length += std::to_integer<std::size_t>(in[i++]);
    }
    length += 2;
    if (i >= in.size()) return false;
    const std::size_t back = ((control & 0x1fU) << 8U) + std::to_integer<std::size_t>(in[i++]) + 1;
    if (back > o || length > out.size() - o) return false;
    // Byte by byte: a reference may overlap what it writes.
    for (std::size_t k = 0; k < length; ++k, ++o) out[o] = out[o - back];
  }
  return o == out.size();
}

std::vector<std::byte> lzf_compress(std::span<const std::byte> in) {
  std::vector<std::byte> out;
  std::vector<std::size_t> last(1U << 14U, kNowhere);
  std::size_t literal = 0;  // begin of the bytes not yet written
  const auto flush = [&](std::size_t end) {
    while (literal < end) {
      const std::size_t length = std::min(end - literal, kLongestLiteral);
      out.push_back(static_cast<std::byte>(length - 1));
      out.insert(out.end(), in.begin() + static_cast<std::ptrdiff_t>(literal),
                 in.begin() + static_cast<std::ptrdiff_t>(literal + length));
      literal += length;
    }
  };
  std::size_t i = 0;
  while (i + 2 < in.size()) {
    const std::uint32_t three = std::to_integer<std::uint32_t>(in[i]) |
                                std::to_integer<std::uint32_t>(in[i + 1]) << 8U |
                                std::to_integer<std::uint32_t>(in[i + 2]) << 16U;
    std::size_t& slot = last[(three * 2654435761U) >> 18U];
    const std::size_t candidate = slot;
    slot = i;
    std::size_t length = 0;
    if (candidate != kNowhere && i - candidate <= kFarthest) {
      const std::size_t limit = std::min(kLongestMatch, in.size() - i);
      while (length < limit && in[candidate + length] == in[i + length]) ++length;
    }
    if (length < 3) {
      ++i;
      continue;
    }
    flush(i);
    const std::size_t back = i - candidate - 1, code = length - 2;
    out.push_back(static_cast<std::byte>((std::min<std::size_t>(code, 7) << 5U) | (back >> 8U)));
    if (code >= 7) out.push_back(static_cast<std::byte>(code - 7));
    out.push_back(static_cast<std::byte>(back & 0xffU));
    i += length;
    literal = i;
  }
  flush(in.size());
  return out;
}

}  // namespace groundloop::recordings
