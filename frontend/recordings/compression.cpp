#include "frontend/recordings/compression.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <memory>

#include <bzlib.h>
#include <fcntl.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zstd.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::uint64_t kLargest = 1ULL << 31U;
constexpr std::uint64_t kUnsuspicious = 1ULL << 26U;
constexpr std::uint64_t kGreatestRatio = 1000;
constexpr std::uint64_t kLongestFile = 1ULL << 50U;

bool decompress_lz4(std::span<const std::byte> in, std::vector<std::byte>& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) return false;
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  std::size_t read = 0, written = 0;
  while (read < in.size()) {
    std::size_t from = in.size() - read, to = out.size() - written;
    const std::size_t hint =
        LZ4F_decompress(context.get(), out.data() + written, &to, in.data() + read, &from, nullptr);
    if (LZ4F_isError(hint) != 0) return false;
    read += from;
    written += to;
    if (hint == 0) break;
    if (from == 0 && to == 0) return false;  // wants more than there is
  }
  return written == out.size();
}

bool decompress_bz2(std::span<const std::byte> in, std::vector<std::byte>& out) {
  auto size = static_cast<unsigned>(out.size());
  // The library's interface takes non-const input that it does not change.
  const int result =
      BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(out.data()), &size,
                                 const_cast<char*>(reinterpret_cast<const char*>(in.data())),
                                 static_cast<unsigned>(in.size()), 0, 0);
  return result == BZ_OK && size == out.size();
}

constexpr std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) {
      value = (value >> 1U) ^ ((value & 1U) != 0 ? 0xedb88320U : 0U);
    }
    table[i] = value;
  }
  return table;
}

}  // namespace

std::optional<Compression> compression_of(std::string_view name) {
  if (name.empty() || name == "none") return Compression::none;
  if (name == "lz4") return Compression::lz4;
  if (name == "bz2") return Compression::bz2;
  if (name == "zstd") return Compression::zstd;
  return std::nullopt;
}

std::uint64_t largest_unpacked(std::uint64_t stored) {
  return std::max(kUnsuspicious, kGreatestRatio * std::min(stored, kLongestFile));
}

bool is_plausible_size(std::uint64_t stored, std::uint64_t announced) {
  return announced <= kLargest && announced <= largest_unpacked(stored);
}

bool decompress(Compression kind, std::span<const std::byte> in, std::size_t size,
                std::vector<std::byte>& out) {
  if (!is_plausible_size(in.size(), size)) return false;
  if (kind == Compression::none) {
    if (in.size() != size) return false;
    out.assign(in.begin(), in.end());
    return true;
  }
  out.resize(size);
  if (size == 0) return true;
  if (kind == Compression::lz4) return decompress_lz4(in, out);
  if (kind == Compression::bz2) return decompress_bz2(in, out);
  const std::size_t written = ZSTD_decompress(out.data(), out.size(), in.data(), in.size());
  return ZSTD_isError(written) == 0 && written == out.size();
}

bool decompress_zstd(std::span<const std::byte> in, std::vector<std::byte>& out) {
  const unsigned long long size = ZSTD_getFrameContentSize(in.data(), in.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) return false;
  return decompress(Compression::zstd, in, size, out);
}

bool decompress_zstd_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::uintmax_t stored = 0;
  std::ifstream in = open_for_reading(from, stored);
  // Nothing that was there is followed or written over.
  const FileDescriptor out(
      ::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  const auto fail_to_write = [&](int error) -> InputError {
    return InputError(to.string() + ": cannot be written: " + write_error_text(error) +
                      "; unpacking " + from.string() +
                      " needs room there (TMPDIR names another "
                      "folder)");
  };
  if (!out) throw fail_to_write(errno);
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  std::vector<char> input(ZSTD_DStreamInSize()), output(ZSTD_DStreamOutSize());
  const std::uint64_t most = largest_unpacked(stored);
  std::uint64_t unpacked = 0;
  std::size_t state = 1;  // 0 once a frame is complete
  while (in) {
    in.read(input.data(), static_cast<std::streamsize>(input.size()));
    ZSTD_inBuffer source = {input.data(), static_cast<std::size_t>(in.gcount()), 0};
    while (source.pos < source.size) {
      ZSTD_outBuffer sink = {output.data(), output.size(), 0};
      state = ZSTD_decompressStream(context.get(), &sink, &source);
      if (ZSTD_isError(state) != 0) {
        throw InputError(from.string() + ": its compressed data are broken (" +
                         ZSTD_getErrorName(state) + ")");
      }
      unpacked += sink.pos;
      if (unpacked > most) {
        throw InputError(
            from.string() + ": unpacks to more than " + std::to_string(most) + " bytes from " +
            std::to_string(stored) +
            ", which no recording does; unpack it by hand with `zstd -d` if it is one");
      }
      for (std::size_t done = 0; done < sink.pos;) {
        const ssize_t written = ::write(out.get(), output.data() + done, sink.pos - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw fail_to_write(errno);
        done += static_cast<std::size_t>(written);
      }
    }
  }
  return state == 0;
}

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t crc) {
  static constexpr std::array<std::uint32_t, 256> table = make_crc_table();
  crc = ~crc;
  for (const std::byte b : bytes) {
    crc = table[(crc ^ std::to_integer<std::uint32_t>(b)) & 0xffU] ^ (crc >> 8U);
  }
  return ~crc;
}

}  // namespace groundloop::recordings
