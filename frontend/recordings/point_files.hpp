// Scan files that describe their own fields: PCD (ascii, binary, binary_compressed) and PLY (ascii,
// little and big endian). Parsed in place; values are decoded by point_layout.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frontend/recordings/point_layout.hpp"

namespace groundloop::recordings {

/// Parses a file's bytes; `bytes` is replaced by decoded ones where they are text or compressed,
/// and the table's offsets are into it. Throws InputError beginning with `where`.
[[nodiscard]] PointTable parse_pcd(std::vector<std::byte>& bytes, const std::string& where);
[[nodiscard]] PointTable parse_ply(std::vector<std::byte>& bytes, const std::string& where);

}  // namespace groundloop::recordings
