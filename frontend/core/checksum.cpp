#include "frontend/core/checksum.hpp"

#include <array>
#include <cstdio>
#include <fstream>
#include <new>
#include <vector>

#include <xxhash.h>

#include "frontend/core/files.hpp"

namespace groundloop {

void Checksum::Free::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

Checksum::Checksum() : state_(XXH3_createState()) {
  if (!state_ || XXH3_64bits_reset(state_.get()) != XXH_OK) throw std::bad_alloc();
}

Checksum& Checksum::add(std::span<const std::byte> bytes) {
  XXH3_64bits_update(state_.get(), bytes.data(), bytes.size());
  return *this;
}

Checksum& Checksum::add(std::string_view text) { return add(std::as_bytes(std::span(text))); }

std::uint64_t Checksum::value() const { return XXH3_64bits_digest(state_.get()); }

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t checksum(std::string_view text) { return checksum(std::as_bytes(std::span(text))); }

std::uint64_t checksum_of_file(const std::filesystem::path& file) {
  std::uintmax_t size = 0;
  std::ifstream in = open_for_reading(file, size);
  std::vector<std::byte> buffer(1 << 20);
  Checksum sum;
  while (in) {
    in.read(reinterpret_cast<char*>(buffer.data()), static_cast<std::streamsize>(buffer.size()));
    sum.add({buffer.data(), static_cast<std::size_t>(in.gcount())});
  }
  return sum.value();
}

std::string hex(std::uint64_t value) {
  std::array<char, 20> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%016llx", static_cast<unsigned long long>(value));
  return buffer.data();
}

}  // namespace groundloop
