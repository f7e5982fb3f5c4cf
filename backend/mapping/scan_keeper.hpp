// Keeps scans in the session while they come in (backend/session/scan_file.hpp): those that the
// sensor moved or turned between, one point a voxel. Memory holds one unfinished file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <vector>

#include "backend/session/scan_file.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"
#include "frontend/odometry/preprocessing.hpp"

namespace groundloop {

struct KeptScanOptions {
  bool keep = true;
  double voxel_size = 0.25;
  double spacing = 0.5;
  double turn_deg = 5.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("keep", self.keep, OnOff{}, "",
          "keep scans in the session: maps are then put together from them at their final poses; "
          "without, from local maps as odometry built them");
    field("voxel_size", self.voxel_size, Range{0.01, 10.0}, "m",
          "one point a voxel of each scan is kept, six bytes (eight with intensity)");
    field("spacing", self.spacing, Range{0.0, 100.0}, "m",
          "way from the last kept scan after which another is kept; scans in between show the same "
          "from the same place");
    field("turn_deg", self.turn_deg, Range{0.0, 180.0}, "deg",
          "turn after which one is kept all the same: where it looks has changed");
  }
};

class ScanKeeper {
 public:
  ScanKeeper(SessionFolder folder, const KeptScanOptions& options);

  [[nodiscard]] bool keeps() const { return options_.keep; }
  /// The next scan of the recording: its points, deskewed, in the scan frame, and their intensities
  /// or none. Writes a file once one is full. Throws InputError where it cannot be written.
  void add(const Points& points, const std::vector<float>& intensity, const Pose& T_world_scan);
  /// Writes what is left.
  void finish();
  /// Files that are written.
  [[nodiscard]] std::size_t files() const { return files_; }

  /// Exact state for a resumable session.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  [[nodiscard]] bool wanted(const Pose& T_world_scan) const;

  SessionFolder folder_;
  KeptScanOptions options_;
  std::uint32_t next_scan_ = 0;
  std::size_t files_ = 0;
  std::optional<Pose> last_;  // T_world_scan of the last that was kept
  ScanFileBuilder file_;
  VoxelDownsampler downsampler_;
};

}  // namespace groundloop
