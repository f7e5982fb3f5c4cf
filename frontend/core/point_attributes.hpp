// What a sensor tells of a point beside where it is and when: kept in a scan for those who ask for
// it, and nothing but empty lists for those who do not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace groundloop {

/// Which attributes a recording has, or a reader is asked for.
struct AttributeSet {
  bool intensity = false;
  bool reflectivity = false;
  bool ring = false;
  bool return_number = false;

  [[nodiscard]] static AttributeSet all() { return {true, true, true, true}; }
  [[nodiscard]] bool any() const { return intensity || reflectivity || ring || return_number; }
  /// Those that are in both.
  [[nodiscard]] AttributeSet operator&(const AttributeSet& other) const {
    return {intensity && other.intensity, reflectivity && other.reflectivity, ring && other.ring,
            return_number && other.return_number};
  }
  bool operator==(const AttributeSet&) const = default;
};

/// One value a point, or empty. Values are the recording's own: what a reader would scale, it
/// could not scale back.
struct PointAttributes {
  std::vector<float> intensity;             ///< strength of the echo; 0 to 1, 0 to 255 or counts
  std::vector<float> reflectivity;          ///< the same, corrected for range by the sensor
  std::vector<std::uint16_t> ring;          ///< which laser, from 0; the order is the recording's
  std::vector<std::uint8_t> return_number;  ///< which echo of a shot, from 1

  /// Calls f(list) for each of the four lists.
  template <typename Self, typename F>
  static void visit(Self&& self, F&& f) {
    f(self.intensity);
    f(self.reflectivity);
    f(self.ring);
    f(self.return_number);
  }
  [[nodiscard]] AttributeSet present() const {
    return {!intensity.empty(), !reflectivity.empty(), !ring.empty(), !return_number.empty()};
  }
};

}  // namespace groundloop
