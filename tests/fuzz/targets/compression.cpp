// Chunks of bags: lz4, bz2 and zstd, by the first byte, and the size that was announced. And whole
// zstd files.
#include "frontend/recordings/compression.hpp"

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(compression) {
  Chooser chooser(input);
  const auto kind = chooser.get<std::uint8_t>() % 6U;
  const auto size = chooser.get<std::uint32_t>();
  std::vector<std::byte> out;
  if (kind == 4) {
    (void)recordings::decompress_zstd(chooser.rest(), out);
  } else if (kind == 5) {
    const auto packed = scratch_file("packed", text_of(chooser.rest()));
    const auto unpacked = scratch_folder() / "unpacked";
    std::filesystem::remove(unpacked);
    (void)recordings::decompress_zstd_file(packed, unpacked);
    FUZZ_PROMISE(std::filesystem::file_size(unpacked) <=
                 recordings::largest_unpacked(input.size()));
  } else if (recordings::decompress(static_cast<recordings::Compression>(kind), chooser.rest(),
                                    size, out)) {
    FUZZ_PROMISE(out.size() == size);
  }
  (void)recordings::crc32(input);
}
