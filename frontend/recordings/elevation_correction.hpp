// KITTI's elevation error: its scans were computed with a calibration of the HDL-64E that is 0.205
// degrees off in elevation. Found here: whether scans are of that sensor, and the correction.
#pragma once

#include <string>

#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

inline constexpr double kKittiElevationCorrectionDeg = 0.205;

/// Raises every point by `degrees` in elevation, its range and azimuth unchanged.
void correct_elevation(Points& points, double degrees);

/// What an elevation histogram over sampled scans says of the sensor.
struct SensorSignature {
  bool kitti_hdl64 = false;
  double lowest_deg = 0.0, highest_deg = 0.0;
  std::string reason;  ///< why it is or is not KITTI's sensor
};
/// Judges by the field of view of an HDL-64E: +2 to -24.8 degrees.
[[nodiscard]] SensorSignature sensor_signature(Recording& recording);

}  // namespace groundloop::recordings
