// Which recording this is, wherever it lies: what a session remembers so that it is not resumed
// with another one.
#pragma once

#include <string>

#include "frontend/recordings/recording.hpp"

namespace groundloop {

/// Checksum of the format, the number of scans, their stamps, and the points of the first scan that
/// can be read. Reads one scan.
[[nodiscard]] std::string recording_fingerprint(Recording& recording);

}  // namespace groundloop
