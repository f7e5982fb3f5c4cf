#include "frontend/recordings/chunk_store.hpp"

#include <algorithm>

#include <fcntl.h>
#include <unistd.h>

#include "frontend/core/error.hpp"

namespace groundloop::recordings {

ChunkStore::ChunkStore(const std::filesystem::path& file)
    : file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_ < 0) throw InputError(file.string() + ": cannot be opened; check its permissions");
  std::error_code error;
  file_size_ = std::filesystem::file_size(file, error);
}

ChunkStore::~ChunkStore() {
  if (file_ >= 0) ::close(file_);
}

std::vector<std::byte> ChunkStore::read_file(std::uint64_t offset, std::uint64_t size) const {
  std::vector<std::byte> bytes;
  if (offset >= file_size_) return bytes;
  bytes.resize(std::min(size, file_size_ - offset));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

std::size_t ChunkStore::add(const Chunk& chunk) {
  chunks_.push_back(chunk);
  return chunks_.size() - 1;
}

bool ChunkStore::load(std::size_t index, std::span<const std::byte>& bytes) {
  if (index != loaded_) {
    loaded_ = kNone;
    const Chunk& chunk = chunks_.at(index);
    std::vector<std::byte> stored = read_file(chunk.offset, chunk.stored);
    if (stored.size() != chunk.stored) return false;
    if (chunk.compression == Compression::none) {
      if (chunk.size != chunk.stored) return false;
      bytes_ = std::move(stored);
    } else if (!decompress(chunk.compression, stored, chunk.size, bytes_)) {
      return false;
    }
    loaded_ = index;
  }
  bytes = bytes_;
  return true;
}

bool ChunkStore::read(std::size_t index, std::uint64_t offset, std::uint64_t size,
                      std::vector<std::byte>& out) {
  const Chunk& chunk = chunks_.at(index);
  if (offset > chunk.size || size > chunk.size - offset) return false;
  if (index != loaded_ && chunk.compression == Compression::none) {
    out = read_file(chunk.offset + offset, size);
    return out.size() == size;
  }
  std::span<const std::byte> bytes;
  if (!load(index, bytes)) return false;
  const auto part = bytes.subspan(offset, size);
  out.assign(part.begin(), part.end());
  return true;
}

}  // namespace groundloop::recordings
