// The bridge between the two quarters: hundreds of metres on which everything repeats, arch by
// arch, so that one stretch cannot be told from the next. A trap for any matcher of places.
#pragma once

#include "frontend/simulation/mesh.hpp"
#include "frontend/simulation/street_network.hpp"

namespace groundloop::simulation {

class Bridge {
 public:
  static constexpr double period = 24.0;  ///< of arches, lamps and piers, m

  explicit Bridge(const Street& street);
  /// Whether the deck, at height 0, carries what stands at p.
  [[nodiscard]] bool carries(const Vec2& p) const;
  [[nodiscard]] bool over_water(const Vec2& p) const;
  /// The height of the land near the river: `land` farther off, level at the bridge's ends.
  [[nodiscard]] double bank(const Vec2& p, double land) const;
  /// The bays whose middle lies within half_size (maximum norm) of a point.
  void build(Mesh& mesh, double half_size, const Vec2& centre) const;

 private:
  void build_bay(Mesh& mesh, const Vec2& start) const;

  Street street_;
  Vec2 along_;
  Vec2 start_;  ///< of the first bay
  int bays_;
  double half_width_;   ///< of the deck with its pavements
  double west_, east_;  ///< x of the river's banks
};

}  // namespace groundloop::simulation
