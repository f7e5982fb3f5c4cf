// Messages as ROS 1 serialises them and as CDR does, value by value.
#pragma once

#include <span>
#include <string>

#include "frontend/core/scan.hpp"
#include "frontend/recordings/byte_cursor.hpp"

namespace groundloop::recordings {

enum class Encoding { ros1, cdr };

struct MessageHeader {
  Nanoseconds stamp = 0;
  std::string frame;
};

/// Reads the primitives of either encoding. CDR aligns numbers to their size, counted from behind
/// its four bytes of encapsulation, and ends strings with a zero.
class MessageReader {
 public:
  MessageReader(std::span<const std::byte> message, Encoding encoding)
      : cdr_(encoding == Encoding::cdr), cursor_(body(message)) {}

  template <typename T>
  T number() {
    if (cdr_) cursor_.align(sizeof(T));
    return cursor_.get<T>();
  }
  std::string text() {
    const auto length = number<std::uint32_t>();
    const auto part = cursor_.take(length);
    std::string value(reinterpret_cast<const char*>(part.data()), part.size());
    if (cdr_ && !value.empty() && value.back() == '\0') value.pop_back();
    return value;
  }
  std::span<const std::byte> bytes(std::size_t size) { return cursor_.take(size); }
  std::span<const std::byte> blob() { return cursor_.take(number<std::uint32_t>()); }
  Nanoseconds time() {
    const Nanoseconds seconds =
        cdr_ ? Nanoseconds{number<std::int32_t>()} : Nanoseconds{number<std::uint32_t>()};
    return seconds * 1'000'000'000 + number<std::uint32_t>();
  }
  /// std_msgs/Header: a sequence number in ROS 1, stamp, frame.
  MessageHeader header() {
    MessageHeader header;
    if (!cdr_) (void)number<std::uint32_t>();
    header.stamp = time();
    header.frame = text();
    return header;
  }
  [[nodiscard]] bool failed() const { return broken_ || cursor_.failed(); }

 private:
  ByteCursor body(std::span<const std::byte> message) {
    if (!cdr_) return ByteCursor(message);
    // Encapsulation: two bytes of representation (0, endianness), two of options.
    if (message.size() < 4 || message[0] != std::byte{0} || message[1] > std::byte{0x0b}) {
      broken_ = true;
      return ByteCursor({});
    }
    const bool little = (std::to_integer<unsigned>(message[1]) & 1U) != 0;
    return ByteCursor(message.subspan(4), !little);
  }
  bool cdr_;
  bool broken_ = false;
  ByteCursor cursor_;
};

}  // namespace groundloop::recordings
