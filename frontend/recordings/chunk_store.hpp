// Chunks of a bag: runs of messages compressed together. One decompressed chunk is kept, so that
// messages read in order decompress each chunk once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <vector>

#include "frontend/recordings/compression.hpp"

namespace groundloop::recordings {

struct Chunk {
  std::uint64_t offset = 0;  ///< of its stored bytes in the file
  std::uint64_t stored = 0;
  std::uint64_t size = 0;  ///< decompressed
  Compression compression = Compression::none;
};

class ChunkStore {
 public:
  /// Throws InputError where the file cannot be opened.
  explicit ChunkStore(const std::filesystem::path& file);
  ~ChunkStore();
  ChunkStore(const ChunkStore&) = delete;
  ChunkStore& operator=(const ChunkStore&) = delete;

  [[nodiscard]] std::uint64_t file_size() const { return file_size_; }
  /// Up to `size` bytes of the file from `offset`; fewer at its end.
  [[nodiscard]] std::vector<std::byte> read_file(std::uint64_t offset, std::uint64_t size) const;

  std::size_t add(const Chunk& chunk);
  [[nodiscard]] bool is_compressed(std::size_t chunk) const {
    return chunks_.at(chunk).compression != Compression::none;
  }
  /// The chunk's decompressed bytes, valid until the next call; false where it is broken.
  [[nodiscard]] bool load(std::size_t chunk, std::span<const std::byte>& bytes);
  /// Bytes [offset, offset + size) of a chunk; of an uncompressed one only these are read.
  [[nodiscard]] bool read(std::size_t chunk, std::uint64_t offset, std::uint64_t size,
                          std::vector<std::byte>& out);

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  int file_ = -1;
  std::uint64_t file_size_ = 0;
  std::vector<Chunk> chunks_;
  std::size_t loaded_ = kNone;
  std::vector<std::byte> bytes_;
};

}  // namespace groundloop::recordings
