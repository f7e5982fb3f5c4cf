// LZF, as compressed PCD files use it: decompression of anything, and of what was compressed.
#include "frontend/recordings/lzf.hpp"

#include <algorithm>

#include "tests/fuzz/fuzz_target.hpp"

GROUNDLOOP_FUZZ_TARGET(lzf) {
  Chooser chooser(input);
  std::vector<std::byte> out(chooser.get<std::uint16_t>());
  (void)recordings::lzf_decompress(chooser.rest(), out);

  const std::vector<std::byte> packed = recordings::lzf_compress(input);
  std::vector<std::byte> again(input.size());
  FUZZ_PROMISE(recordings::lzf_decompress(packed, again));
  FUZZ_PROMISE(std::equal(again.begin(), again.end(), input.begin(), input.end()));
}
