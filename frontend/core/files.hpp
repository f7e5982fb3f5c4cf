// Files as every reader of groundloop treats them: read whole, or fail with a name. And numbers as
// text. Writing is output_file.hpp's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace groundloop {

/// The file opened, and its size. Throws InputError naming the file and the reason.
[[nodiscard]] std::ifstream open_for_reading(const std::filesystem::path& file,
                                             std::uintmax_t& size);
/// Bytes of a file. Throws InputError naming the file and the reason.
[[nodiscard]] std::vector<std::byte> read_file(const std::filesystem::path& file);
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

/// Files of a folder whose name ends in `extension` (with the dot, case ignored; empty: all), in
/// natural order
/// ("9.bin" before "10.bin"). Throws InputError where the folder cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> list_files(const std::filesystem::path& folder,
                                                            std::string_view extension);
/// True where a goes before b in natural order: runs of digits compare as numbers.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b);

/// A double in the fewest digits that read back the same.
[[nodiscard]] std::string to_text(double value);
/// Seconds with nine decimals from nanoseconds, exactly.
[[nodiscard]] std::string seconds_text(std::int64_t nanoseconds);
/// Nanoseconds from decimal seconds ("1317354879.123456789", also "1.5e3"), exact to the nanosecond
/// for plain decimals. Returns false where the text is no number, or beyond kFarthestStamp.
[[nodiscard]] bool parse_seconds(std::string_view text, std::int64_t& nanoseconds);
/// A finite double from the whole of `text`; returns false otherwise.
[[nodiscard]] bool parse_double(std::string_view text, double& value);

}  // namespace groundloop
