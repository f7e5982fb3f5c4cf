// Directions of a spinning sensor's beams: from a calibration file, or a model's nominal ones.
#pragma once

#include <filesystem>
#include <vector>

namespace groundloop::recordings {

/// One laser; angles in radians, offsets in metres.
struct Beam {
  double elevation = 0.0;
  double azimuth = 0.0;        ///< added to the encoder's, clockwise seen from above
  double range_offset = 0.0;   ///< added to the measured range
  double height_offset = 0.0;  ///< of the laser above the centre, across its beam
  double side_offset = 0.0;    ///< of the laser beside the centre
};
using BeamTable = std::vector<Beam>;

/// Velodyne's calibration as its ROS driver keeps it: YAML with a list `lasers`. Throws InputError
/// naming the file where it is none or holds another number of lasers.
[[nodiscard]] BeamTable read_velodyne_calibration(const std::filesystem::path& file,
                                                  std::size_t beams);
/// Hesai's correction file: "channel,elevation,azimuth" (degrees), one line a laser. Throws
/// likewise.
[[nodiscard]] BeamTable read_hesai_calibration(const std::filesystem::path& file,
                                               std::size_t beams);

/// Of the users' manuals.
[[nodiscard]] BeamTable nominal_vlp16();
[[nodiscard]] BeamTable nominal_puck_hires();
[[nodiscard]] BeamTable nominal_hdl32();
[[nodiscard]] BeamTable nominal_vlp32c();
[[nodiscard]] BeamTable nominal_vls128();
[[nodiscard]] BeamTable nominal_xt32();

/// For each beam its place from the lowest, 0, to the highest.
[[nodiscard]] std::vector<std::uint16_t> rings_of(const BeamTable& beams);

}  // namespace groundloop::recordings
