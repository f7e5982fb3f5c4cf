// PCD files of any program: ascii, binary and compressed.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/point_files.hpp"

GROUNDLOOP_FUZZ_TARGET(pcd) {
  std::vector<std::byte> bytes(input.begin(), input.end());
  const recordings::PointTable table = recordings::parse_pcd(bytes, "input");
  decode_table(table.layout, bytes, table.count, 1'700'000'000'000'000'000);
}
