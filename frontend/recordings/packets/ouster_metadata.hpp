// What an Ouster sensor says of itself in JSON: the form of its packets and the directions of its
// beams. Old metadata keep everything on one level, newer ones in groups.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frontend/core/pose.hpp"

namespace groundloop::recordings {

struct OusterMetadata {
  std::string product;  ///< e.g. OS-1-64
  std::string profile;  ///< e.g. LEGACY, RNG15_RFL8_NIR8
  std::size_t columns_per_frame = 0, columns_per_packet = 16, rows = 0;
  std::vector<double> elevations, azimuths;  ///< rad, a row each
  double beam_offset = 0.0;                  ///< of a beam's origin from the axis (m)
  Pose T_sensor_lidar;
  std::vector<std::string> assumed;  ///< what was not there and is taken to be usual
};

/// Throws InputError beginning with `where`.
[[nodiscard]] OusterMetadata parse_ouster_metadata(const std::string& json,
                                                   const std::string& where);
/// True where the text may be such metadata.
[[nodiscard]] bool is_ouster_metadata(const std::string& json);

}  // namespace groundloop::recordings
