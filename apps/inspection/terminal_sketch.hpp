// A scan drawn with characters, for a terminal: Unicode's braille and shades, or plain ASCII. No
// colours are used.
#pragma once

#include <cstddef>
#include <string>

#include "apps/inspection/scan_rasters.hpp"

namespace groundloop::apps {

struct SketchOptions {
  std::size_t columns = 72;  ///< of characters
  bool unicode = true;
};

/// From above, as a range image (near is dark), and the times of its points where it has some; each
/// with a line that says what is seen.
[[nodiscard]] std::string sketch_scan(const Scan& scan, const SketchOptions& options);

/// True where the environment's locale (LC_ALL, LC_CTYPE, LANG) is of UTF-8.
[[nodiscard]] bool locale_is_unicode();

}  // namespace groundloop::apps
