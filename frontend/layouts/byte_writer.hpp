// Bytes of little-endian records, put together in memory and written at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/core/error.hpp"

namespace groundloop::layouts {

class ByteWriter {
 public:
  template <typename T>
  ByteWriter& put(T value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
    return *this;
  }
  ByteWriter& put_bytes(const void* data, std::size_t size) {
    const auto* from = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
    return *this;
  }
  ByteWriter& put_text(std::string_view text) { return put_bytes(text.data(), text.size()); }
  /// With its length before it.
  template <typename Length>
  ByteWriter& put_counted(std::string_view text) {
    return put(static_cast<Length>(text.size())).put_text(text);
  }
  ByteWriter& align(std::size_t size) {
    bytes_.resize((bytes_.size() + size - 1) / size * size);
    return *this;
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] const std::vector<std::byte>& bytes() const { return bytes_; }
  [[nodiscard]] std::string_view view() const {
    return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
  }

 private:
  std::vector<std::byte> bytes_;
};

/// Writes a file of a folder that is itself put in place when it is whole.
inline void write_bytes(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw InputError(file.string() + ": cannot be written; is the disk full?");
}

}  // namespace groundloop::layouts
