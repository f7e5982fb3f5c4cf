// Which sensor scans are of, as far as their points tell: field of view, beams, and the model whose
// published beams agree with those measured. For reading by people: nothing is decided by it.
#pragma once

#include <string>
#include <vector>

#include "frontend/core/scan.hpp"

namespace groundloop::recordings {

/// E.g. "32 rings from -30.7 to +10.6 degrees, whole turn: as of a Velodyne HDL-32E (beams agree to
/// 0.05 degrees)". Rings are used where the scans have them. Empty where there are too few points.
[[nodiscard]] std::string recognise_sensor(const std::vector<Scan>& scans);

}  // namespace groundloop::recordings
