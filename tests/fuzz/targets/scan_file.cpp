// Kept scans of a session, behind a checksum that is right.
#include "backend/session/scan_file.hpp"

#include <cstring>

#include "frontend/core/checksum.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(scan_file) {
  constexpr std::size_t kSummedFrom = 16;  // bytes
  std::string bytes(text_of(input));
  if (bytes.size() >= kSummedFrom) {
    const std::uint64_t sum = checksum(std::string_view(bytes).substr(kSummedFrom));
    std::memcpy(bytes.data() + sizeof kScanFileMagic, &sum, sizeof sum);
  }
  const auto file = scratch_file("scans.bin", bytes);
  const std::vector<KeptScan> scans = read_scan_file(file);
  ScanFileBuilder again;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    FUZZ_PROMISE(i == 0 || scans[i].scan > scans[i - 1].scan);
    FUZZ_PROMISE(scans[i].intensity.empty() || scans[i].intensity.size() == scans[i].points.size());
    for (const Eigen::Vector3f& p : scans[i].points) FUZZ_PROMISE(p.allFinite());
    again.add(scans[i]);
  }
  const auto other = scratch_folder() / "again.bin";
  again.write(other);
  FUZZ_PROMISE(read_scan_file(other).size() == scans.size());
}
