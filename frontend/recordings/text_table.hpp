// Headers and tables of numbers in text, as PCD and PLY have them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/recordings/point_layout.hpp"

namespace groundloop::recordings {

/// Lines of a header that precedes binary data.
class LineReader {
 public:
  explicit LineReader(std::span<const std::byte> bytes)
      : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}
  /// The next line without its end; false at the end of the bytes, and where a "line" is so long
  /// that this is no header.
  bool next(std::string_view& line);
  /// Bytes consumed so far: where data begin after the last header line.
  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t line_number() const { return line_; }

 private:
  std::string_view text_;
  std::size_t position_ = 0, line_ = 0;
};

[[nodiscard]] std::vector<std::string_view> split(std::string_view line);

/// A whole number of a header; throws InputError beginning with `where` for anything else.
[[nodiscard]] std::size_t parse_count(std::string_view text, const std::string& where);

/// Reads `count` lines of numbers from byte `begin` and returns them as packed records of `layout`.
/// `columns` gives the values of each field (1 mostly). Throws InputError naming the line.
[[nodiscard]] std::vector<std::byte> parse_text_records(std::span<const std::byte> bytes,
                                                        std::size_t begin, std::size_t count,
                                                        const PointLayout& layout,
                                                        const std::vector<std::size_t>& columns,
                                                        const std::string& where);

}  // namespace groundloop::recordings
