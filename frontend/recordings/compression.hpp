// Decompression of the chunks and messages of bags, with the sizes that files announce held against
// what can be true, and the checksum of MCAP.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace groundloop::recordings {

enum class Compression { none, lz4, bz2, zstd };

/// By the name that bags use ("", "none", "lz4", "bz2", "zstd"); nothing for others.
[[nodiscard]] std::optional<Compression> compression_of(std::string_view name);

/// What `stored` bytes may unpack to: a thousandfold, or 64 MiB.
[[nodiscard]] std::uint64_t largest_unpacked(std::uint64_t stored);
/// False where `announced` bytes cannot have come out of `stored` ones, or are more than 2 GiB.
[[nodiscard]] bool is_plausible_size(std::uint64_t stored, std::uint64_t announced);

/// Decompresses into exactly `size` bytes; false where the data are broken or of another size.
[[nodiscard]] bool decompress(Compression kind, std::span<const std::byte> in, std::size_t size,
                              std::vector<std::byte>& out);

/// Decompresses a zstd frame that tells its own size; false where it is broken or tells none.
[[nodiscard]] bool decompress_zstd(std::span<const std::byte> in, std::vector<std::byte>& out);

/// Decompresses a .zstd file to `to`, which must not be there yet, in bounded memory and to at most
/// largest_unpacked() bytes; false where it is cut off, and what stands before was unpacked. Throws
/// InputError naming the file.
[[nodiscard]] bool decompress_zstd_file(const std::filesystem::path& from,
                                        const std::filesystem::path& to);

/// CRC-32 (IEEE 802.3); `crc` continues an earlier call's result.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t crc = 0);

}  // namespace groundloop::recordings
