// LZF, the compression of binary_compressed PCD files: literal runs and references of at most
// 8 KiB back, written from the description of the format.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace groundloop::recordings {

/// Decompresses into exactly out.size() bytes; false where the stream is broken or of other length.
[[nodiscard]] bool lzf_decompress(std::span<const std::byte> in, std::span<std::byte> out);

[[nodiscard]] std::vector<std::byte> lzf_compress(std::span<const std::byte> in);

}  // namespace groundloop::recordings
