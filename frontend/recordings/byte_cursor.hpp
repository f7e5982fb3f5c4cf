// Reading numbers and strings one after the other from bytes that may end too early.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace groundloop::recordings {

/// Once a read goes beyond the end, failed() is true and everything reads as zero or empty.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::byte> bytes, bool big_endian = false)
      : bytes_(bytes), swap_(big_endian) {}

  template <typename T>
  T get() {
    std::array<std::byte, sizeof(T)> value{};
    const std::span<const std::byte> from = take(sizeof(T));
    std::copy(from.begin(), from.end(), value.begin());
    if (swap_) std::reverse(value.begin(), value.end());
    return std::bit_cast<T>(value);
  }
  std::span<const std::byte> take(std::uint64_t size) {
    if (failed_ || size > bytes_.size() - position_) {
      failed_ = true;
      return {};
    }
    const auto part = bytes_.subspan(position_, size);
    position_ += size;
    return part;
  }
  /// A string or blob with its length before it.
  template <typename Length>
  std::span<const std::byte> take_counted() {
    return take(get<Length>());
  }
  template <typename Length>
  std::string_view get_text() {
    const auto part = take_counted<Length>();
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }
  /// Skips to a multiple of `size` from the first byte.
  void align(std::size_t size) {
    const std::size_t over = position_ % size;
    if (over != 0) (void)take(size - over);
  }
  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t left() const { return failed_ ? 0 : bytes_.size() - position_; }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool swap_ = false, failed_ = false;
};

}  // namespace groundloop::recordings
