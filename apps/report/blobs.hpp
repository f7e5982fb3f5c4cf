// Arrays of numbers on their way into an HTML page: bytes of equal weight put side by side,
// deflated, in base64, one script element each that the browser does not run. The page's own
// data.js undoes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace groundloop::apps {

[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// A zlib stream (RFC 1950). The same bytes for the same input and library.
[[nodiscard]] std::vector<std::byte> deflate_bytes(std::span<const std::byte> bytes);

/// Byte k of every element after byte k-1 of every element: what is alike comes together.
/// `bytes` holds whole elements of `width` bytes.
[[nodiscard]] std::vector<std::byte> shuffle_bytes(std::span<const std::byte> bytes,
                                                   std::size_t width);

class Blobs {
 public:
  /// What stands in the page's document for the array: {blob, type, length}. Numbers are
  /// little-endian.
  [[nodiscard]] nlohmann::ordered_json add(std::span<const float> values);
  [[nodiscard]] nlohmann::ordered_json add(std::span<const double> values);
  [[nodiscard]] nlohmann::ordered_json add(std::span<const std::uint32_t> values);
  [[nodiscard]] nlohmann::ordered_json add(std::span<const std::uint16_t> values);
  [[nodiscard]] nlohmann::ordered_json add(std::span<const std::uint8_t> values);

  /// The script elements of what was added since the last call, in the order of their adding.
  [[nodiscard]] std::string html();
  /// Of all that was added, in base64.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  nlohmann::ordered_json add_bytes(std::span<const std::byte> bytes, std::size_t width,
                                   const char* type);

  std::vector<std::string> texts_;
  std::size_t given_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace groundloop::apps
