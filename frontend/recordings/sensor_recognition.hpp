// Which sensor scans are of, as far as their points tell: field of view, beams, and the models
// whose published beams or views agree with those measured. For reading by people: nothing is
// decided by it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frontend/core/scan.hpp"

namespace groundloop::recordings {

/// What the points of a few scans show.
struct SensorEvidence {
  std::size_t rings = 0;  ///< seen; 0 where scans do not tell the laser
  double lowest_deg = 0.0, highest_deg = 0.0;
  double turn_deg = 0.0;  ///< of 360, in which there are points
  /// Models that it may be, the likeliest first; empty where none agrees.
  std::vector<std::string> models;
  std::string evidence;  ///< why those; a clause

  /// E.g. "32 rings from -30.7 to +10.6 degrees, the whole turn: as of a Velodyne HDL-32E (its 32
  /// beams agree to 0.05 degrees)".
  [[nodiscard]] std::string described() const;
};

/// Rings are used where the scans have them: beams are then compared one by one with the manuals'
/// tables; else the field of view with those published. Nothing (described() is empty) where there
/// are too few points.
[[nodiscard]] SensorEvidence recognise_sensor(const std::vector<Scan>& scans);

}  // namespace groundloop::recordings
