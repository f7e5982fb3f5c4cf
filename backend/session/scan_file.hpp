// Deskewed scans as a session keeps them, so that maps can be put together at the poses that the
// solution found: scans/NNNNNN.bin, some megabytes of successive scans each. Coordinates are whole
// steps of 1/256 m in the scan's frame, six bytes a point; scans that reach farther than 128 m have
// a step twice, four times ... as long. Intensities, where the recording has them, take two more.
//
// Layout, little-endian, packed:
//   u64 magic, u64 checksum (frontend/core/checksum.hpp) of all that follows
//   u32 scans, f32 largest intensity in the file, negative where it has none
//   then each scan, in ascending order of its number:
//     u32 number in its recording, u32 points, f32 step (m), f32 step of the intensities, 0: none
//     points x 3 i16, and with intensities points x u16
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "frontend/core/scan.hpp"

namespace groundloop {

/// "GSCANS01": the first eight bytes of a file of scans; another version has another number.
inline constexpr std::uint64_t kScanFileMagic = 0x3130534e41435347ULL;

struct KeptScan {
  std::uint32_t scan = 0;        ///< its number in the recording, which is its row in trajectories
  Points points;                 ///< scan frame at its stamp, m
  std::vector<float> intensity;  ///< one a point, or none; the recording's own values
};

/// Successive scans on their way into a file.
class ScanFileBuilder {
 public:
  /// Scans in ascending order. Points that are not finite, or farther off than any map (1e5 m), are
  /// left out; intensities below 0 and what is no number become 0, those beyond 65535 that.
  void add(const KeptScan& scan);

  [[nodiscard]] std::size_t scans() const { return scans_; }
  [[nodiscard]] std::size_t bytes() const { return body_.size(); }
  /// Writes the scans (see output_file.hpp) and forgets them.
  void write(const std::filesystem::path& file);

  /// Exact state for a resumable session.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  std::uint32_t scans_ = 0;
  float largest_intensity_ = -1.0F;
  std::vector<char> body_;  // the scans as they lie in the file
};

/// The scans of a file. Throws InputError naming file and place where it is damaged, cut off or no
/// file of scans.
[[nodiscard]] std::vector<KeptScan> read_scan_file(const std::filesystem::path& file);

/// The largest intensity in a file, negative where it has none; reads its head only.
[[nodiscard]] float largest_intensity_of(const std::filesystem::path& file);

}  // namespace groundloop
