// The streets of a simulated world: an endless irregular lattice of crossings joined by bent
// streets, some of them missing, and for the bridge a river without any between two halves of it. A
// function of the seed alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/simulation/mesh.hpp"

namespace groundloop::simulation {

struct Crossing {
  int i = 0, j = 0;
  auto operator<=>(const Crossing&) const = default;
};

/// A street from one crossing to the next, a quadratic Bezier curve.
struct Street {
  Vec2 from, bend, to;
  double half_width = 4.0;  ///< of the carriageway, m
  double pavement = 2.0;    ///< width of the pavement on each side, m
  bool bridge = false;
  std::uint64_t key = 0;

  [[nodiscard]] Vec2 point(double t) const;
  /// Unit vector along the street.
  [[nodiscard]] Vec2 direction(double t) const;
  [[nodiscard]] double length() const;
  /// Distance from the middle to the edge of the pavements, m.
  [[nodiscard]] double edge() const { return half_width + pavement; }
  /// Where people walk, metres from the middle: nearer the houses than the kerb, at which cars are
  /// parked and lamps stand; well on a path that has no kerb.
  [[nodiscard]] double walking_line() const {
    return pavement < 1.0 ? 0.6 * half_width : half_width + 0.5 * pavement + 0.25;
  }
  /// The middle of the lane beside the oncoming one, metres from the middle of the street. Two cars
  /// pass each other there, and a parked one.
  [[nodiscard]] double driving_lane() const { return std::clamp(0.4 * half_width, 0.95, 1.7); }
};

struct StreetNetworkOptions {
  double min_half_width = 4.2, max_half_width = 5.4;  ///< of carriageways, m
  double avenues = 0.2;                               ///< share of streets with two lanes each way
  double min_pavement = 2.0, max_pavement = 3.2;      ///< m
  double bend = 16.0;                                 ///< of streets out of the straight line, m
  int river = 0;  ///< width, in spacings, of a river that only one bridge crosses; 0: none
};

class StreetNetwork {
 public:
  static constexpr double spacing = 100.0;  ///< of crossings, on average, m

  explicit StreetNetwork(std::uint64_t key, const StreetNetworkOptions& options = {})
      : key_(key), options_(options) {}
  /// The river lies between columns 0 and 1 of crossings, from x = 50 m on.
  [[nodiscard]] int river() const { return options_.river; }
  [[nodiscard]] Vec2 crossing(const Crossing& c) const;
  /// The street to the neighbour east (axis 0) or north (axis 1) of a crossing, if there is one.
  /// Every crossing has at least two streets.
  [[nodiscard]] std::optional<Street> street(const Crossing& c, int axis) const;
  /// The street between two neighbours, directed from a to b.
  [[nodiscard]] std::optional<Street> between(const Crossing& a, const Crossing& b) const;
  /// Streets whose crossings lie within `reach` steps of a crossing.
  [[nodiscard]] std::vector<Street> around(const Crossing& c, int reach) const;

 private:
  std::uint64_t key_;
  StreetNetworkOptions options_;
};

/// Distance of a point from the nearest edge of a street's pavement; negative on it.
[[nodiscard]] double clearance(const std::vector<Street>& streets, const Vec2& p);

}  // namespace groundloop::simulation
