// Bytes of little-endian records, put together in memory and written at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include "frontend/core/error.hpp"

namespace groundloop::layouts {

class ByteWriter {
 public:
  template <typename T>
  ByteWriter& put(T value) {
    return put_bytes(&value, sizeof value);
  }
  ByteWriter& put_bytes(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
    return *this;
  }
  ByteWriter& put_text(std::string_view text) { return put_bytes(text.data(), text.size()); }
  /// With its length before it.
  template <typename Length>
  ByteWriter& put_counted(std::string_view text) {
    return put(static_cast<Length>(text.size())).put_text(text);
  }
  ByteWriter& align(std::size_t size) {
    bytes_.resize((bytes_.size() + size - 1) / size * size, '\0');
    return *this;
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(bytes_.data(), bytes_.size()));
  }
  [[nodiscard]] std::string_view view() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Writes a file of a folder that is itself put in place when it is whole.
inline void write_bytes(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw InputError(file.string() + ": cannot be written; is the disk full?");
}

}  // namespace groundloop::layouts
