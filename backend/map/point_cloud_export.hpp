// Point clouds for other programs: PCD and PLY (binary, float x y z and more) and LAS (1 mm).
// Points come in chunks, their number need not be known before; the header is put right at the end,
// before the file gets its name. Floats hold a millimetre up to 8 km from the origin: larger maps
// belong in LAS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include <Eigen/Core>

namespace groundloop {

struct ExportPoint {
  Eigen::Vector3d position;  ///< world, m
  std::uint16_t session = 0;
  float intensity = 0.0F;
};

/// What a file holds beside positions.
struct ExportFields {
  bool session = false;            ///< PCD, PLY: field `session`, uint16; LAS always has it
  bool intensity = false;          ///< PCD, PLY: field `intensity`, float, as the recording has it
  float largest_intensity = 0.0F;  ///< what LAS, where it is an uint16, scales by
};

class PointCloudWriter {
 public:
  virtual ~PointCloudWriter() = default;
  /// Throws InputError where the format cannot hold a point (LAS: beyond 2147 km).
  virtual void write(std::span<const ExportPoint> points) = 0;
  /// Completes the header and gives the file its name. Without it nothing is left behind.
  virtual void finish() = 0;
  [[nodiscard]] std::uint64_t count() const { return count_; }

 protected:
  std::uint64_t count_ = 0;
};

/// By the ending of `file`: .pcd, .ply or .las (version 1.2, 1.4 beyond 4 294 967 295 points).
/// LAS has the session as point source id, and intensities as its standard has them, normalised to
/// 16 bits: shares of 1 and counts up to 255 over the whole range, others as they are. Throws
/// InputError for another ending or a folder that cannot be written.
[[nodiscard]] std::unique_ptr<PointCloudWriter> open_point_cloud_writer(
    const std::filesystem::path& file, const ExportFields& fields);

}  // namespace groundloop
