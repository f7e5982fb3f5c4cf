// The map from above as a drawing: what stands upright is dark, ground light, what was not seen
// white. Points come one by one; memory is that of the pixels.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "apps/report/grey_picture.hpp"

namespace groundloop::apps {

/// The part of the world that a picture shows. x goes right, y up.
struct TopWindow {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< m, of the lower left corner
  double pixel = 1.0;                             ///< m
  int width = 1;
  int height = 1;
};

/// What holds all of `positions` with a margin for what was seen from them; at most
/// `longest` pixels on a side, none under 0.1 m.
[[nodiscard]] TopWindow window_around(const std::vector<Eigen::Vector3d>& positions,
                                      int longest = 1400);

class TopView {
 public:
  explicit TopView(const TopWindow& window);
  /// World, m. What lies outside the window is left out.
  void add(const Eigen::Vector3f& position);
  [[nodiscard]] const TopWindow& window() const { return window_; }
  /// In sixteen greys, so that it packs well.
  [[nodiscard]] GreyPicture draw() const;

 private:
  /// Heights in units of 5 cm; low > high: nothing seen.
  struct Pixel {
    std::int16_t low = 32767;
    std::int16_t high = -32768;
  };
  TopWindow window_;
  std::vector<Pixel> pixels_;
};

}  // namespace groundloop::apps
