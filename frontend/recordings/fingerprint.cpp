#include "frontend/recordings/fingerprint.hpp"

#include <algorithm>
#include <span>

#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"

namespace groundloop {

std::string recording_fingerprint(Recording& recording) {
  Checksum sum;
  sum.add(recording.info().format).add_value(recording.size());
  for (std::size_t i = 0; i < recording.size(); ++i) sum.add_value(recording.stamp(i));
  constexpr std::size_t kTried = 10;
  for (std::size_t i = 0; i < std::min(kTried, recording.size()); ++i) {
    try {
      const Scan scan = recording.read(i);
      sum.add(std::as_bytes(std::span(scan.points))).add(std::as_bytes(std::span(scan.times)));
      break;
    } catch (const InputError&) {
      sum.add("unreadable");
    }
  }
  return hex(sum.value());
}

}  // namespace groundloop
