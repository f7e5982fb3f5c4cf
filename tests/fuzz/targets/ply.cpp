// PLY files: ascii and binary of both byte orders.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/point_files.hpp"

GROUNDLOOP_FUZZ_TARGET(ply) {
  std::vector<std::byte> bytes(input.begin(), input.end());
  const recordings::PointTable table = recordings::parse_ply(bytes, "input");
  decode_table(table.layout, bytes, table.count, 1'700'000'000'000'000'000);
}
