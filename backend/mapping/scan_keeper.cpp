#include "backend/mapping/scan_keeper.hpp"

#include <cmath>

#include "frontend/core/binary_io.hpp"

namespace groundloop {
namespace {

// A file is a whole that is written, read and checked at once: small against memory, and few enough
// that an hour's drive has some hundreds.
constexpr std::size_t kFileBytes = std::size_t{4} << 20;

}  // namespace

ScanKeeper::ScanKeeper(SessionFolder folder, const KeptScanOptions& options)
    : folder_(std::move(folder)), options_(options) {}

bool ScanKeeper::wanted(const Pose& T_world_scan) const {
  if (!last_) return true;
  const Pose moved = last_->inverse() * T_world_scan;
  return moved.translation.norm() >= options_.spacing ||
         rotation_angle(moved.rotation) >= options_.turn_deg * M_PI / 180.0;
}

void ScanKeeper::add(const Points& points, const std::vector<float>& intensity,
                     const Pose& T_world_scan) {
  const std::uint32_t scan = next_scan_++;
  if (!options_.keep || points.empty() || !wanted(T_world_scan)) return;
  const auto voxel = static_cast<float>(options_.voxel_size);
  KeptScan kept{scan, {}, {}};
  if (intensity.size() == points.size()) {
    kept.intensity = intensity;
    kept.points = downsampler_(points, voxel, kept.intensity);
  } else {
    kept.points = downsampler_(points, voxel);
  }
  file_.add(kept);
  last_ = T_world_scan;
  if (file_.bytes() >= kFileBytes) finish();
}

void ScanKeeper::finish() {
  if (file_.scans() == 0) return;
  file_.write(folder_.scan_file(files_));
  ++files_;
}

void ScanKeeper::save(std::ostream& out) const {
  put(out, next_scan_);
  put(out, files_);
  put(out, last_.has_value());
  put(out, last_.value_or(Pose()));
  file_.save(out);
}

void ScanKeeper::load(std::istream& in) {
  bool has_last = false;
  Pose last;
  get(in, next_scan_);
  get(in, files_);
  get(in, has_last);
  get(in, last);
  last_ = has_last ? std::optional(last) : std::nullopt;
  file_.load(in);
}

}  // namespace groundloop
