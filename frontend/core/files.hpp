// Files as every writer and reader of groundloop treats them: read whole or fail with a name,
// written aside and renamed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace groundloop {

/// Bytes of a file. Throws InputError naming the file and the reason.
[[nodiscard]] std::vector<std::byte> read_file(const std::filesystem::path& file);
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

/// A file that appears under its final name only when commit() has succeeded. Destroyed before
/// that, it leaves nothing.
class AtomicFile {
 public:
  /// Throws InputError where the folder cannot be written.
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ofstream& stream() { return stream_; }
  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Flushes, closes and renames; throws InputError where the disk is full.
  void commit();

 private:
  std::filesystem::path final_;
  std::filesystem::path temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

void write_text_atomically(const std::filesystem::path& file, std::string_view text);

/// Files of a folder whose name ends in `extension` (with the dot, case ignored; empty: all), in
/// natural order
/// ("9.bin" before "10.bin"). Throws InputError where the folder cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> list_files(const std::filesystem::path& folder,
                                                            std::string_view extension);
/// True where a goes before b in natural order: runs of digits compare as numbers.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b);

/// FNV-1a, 64 bits: the checksum of session files.
[[nodiscard]] std::uint64_t fnv1a(std::span<const std::byte> bytes,
                                  std::uint64_t seed = 14695981039346656037ULL);
[[nodiscard]] std::uint64_t fnv1a_of_file(const std::filesystem::path& file);

/// A double in the fewest digits that read back the same.
[[nodiscard]] std::string to_text(double value);
/// Seconds with nine decimals from nanoseconds, exactly.
[[nodiscard]] std::string seconds_text(std::int64_t nanoseconds);
/// Nanoseconds from decimal seconds ("1317354879.123456789", also "1.5e3"), exact to the nanosecond
/// for plain decimals. Returns false where the text is no finite number.
[[nodiscard]] bool parse_seconds(std::string_view text, std::int64_t& nanoseconds);
/// A finite double from the whole of `text`; returns false otherwise.
[[nodiscard]] bool parse_double(std::string_view text, double& value);

}  // namespace groundloop
