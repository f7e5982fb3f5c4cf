// Files built byte by byte, as published descriptions of formats say.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace groundloop::testing {

/// Bytes in order; put() writes a number little-endian, put_big() big-endian.
class Bytes {
 public:
  template <typename T>
  Bytes& put(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    data_.append(bytes, sizeof(T));
    return *this;
  }
  template <typename T>
  Bytes& put_big(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    std::reverse(bytes, bytes + sizeof(T));
    data_.append(bytes, sizeof(T));
    return *this;
  }
  template <typename... T>
  Bytes& floats(T... values) {
    (put(static_cast<float>(values)), ...);
    return *this;
  }
  Bytes& text(const std::string& text) {
    data_ += text;
    return *this;
  }
  /// Length as a little-endian integer, then the bytes.
  template <typename Length>
  Bytes& counted(const std::string& text) {
    return put(static_cast<Length>(text.size())).text(text);
  }
  [[nodiscard]] const std::string& str() const { return data_; }
  [[nodiscard]] std::size_t size() const { return data_.size(); }

 private:
  std::string data_;
};

inline void write_file(const std::filesystem::path& file, const std::string& content) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
}
inline void write_file(const std::filesystem::path& file, const Bytes& content) {
  write_file(file, content.str());
}

}  // namespace groundloop::testing
