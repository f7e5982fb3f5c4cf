// The checksum of groundloop's own files: XXH3, 64 bits (xxHash). It tells damage, not malice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct XXH3_state_s;

namespace groundloop {

/// The name of the checksum as manifests give it.
inline constexpr const char* kChecksumName = "XXH3, 64 bits";

/// Of bytes that come piece by piece.
class Checksum {
 public:
  Checksum();
  Checksum& add(std::span<const std::byte> bytes);
  Checksum& add(std::string_view text);
  template <typename T>
  Checksum& add_value(const T& value) {
    return add(std::as_bytes(std::span(&value, 1)));
  }
  [[nodiscard]] std::uint64_t value() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Free> state_;
};

[[nodiscard]] std::uint64_t checksum(std::span<const std::byte> bytes);
[[nodiscard]] std::uint64_t checksum(std::string_view text);
/// Throws InputError naming the file where it cannot be read.
[[nodiscard]] std::uint64_t checksum_of_file(const std::filesystem::path& file);

/// Sixteen hexadecimal digits.
[[nodiscard]] std::string hex(std::uint64_t value);

}  // namespace groundloop
