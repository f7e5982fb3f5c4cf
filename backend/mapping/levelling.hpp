// Keeps odometry upright over kilometres. The vertical of each local map (vertical.hpp) is compared
// with the world's: what differs is odometry's error in roll and pitch, which closures hardly see,
// since a sensor whose beams point too high by a fraction of a degree shows the same bowl-shaped
// world at every visit. The error is modelled as a bend that grows with the distance in every
// direction, plus a random walk, and found by linear least squares; how large either is, and how
// well the verticals are known, is what makes the verticals most likely, so that a good odometry is
// left alone. The odometry is then unbent, steps kept as they are.
#pragma once

#include <cstddef>
#include <vector>

#include "backend/graph/odometry_information.hpp"
#include "backend/registration/vertical.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop {

struct LevellingOptions {
  bool enabled = true;
  double scatter_deg = 0.25;
  double correlated_surfaces = 6.0;
  int min_maps = 4;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("enabled", self.enabled, OnOff{}, "",
          "correct roll and pitch of the odometry by what stands upright in the local maps");
    field("scatter_deg", self.scatter_deg, Range{0.0, 45.0}, "deg",
          "standard deviation of a map's vertical that no number of walls goes below");
    field("correlated_surfaces", self.correlated_surfaces, Range{1.0, 1e6}, "",
          "cells whose normals share one error (the same wall), so count as one");
    field("min_maps", self.min_maps, Range{2, 1000000}, "",
          "maps with a vertical below which odometry stays as it is");
  }
};

struct Levelling {
  Trajectory odometry;  ///< levelled; as given where `applied` is false
  bool applied = false;
  std::size_t maps = 0;  ///< with a vertical
  /// Tilt that odometry gained per metre away from the start, rad/m, positive where the world was
  /// bent to a bowl; and its standard deviation.
  double bend = 0.0;
  double bend_deviation = 0.0;
  double walk_scale = 0.0;  ///< size of the random walk in units of the stated drift
  double scatter = 0.0;     ///< rms of the verticals about the solution, rad, of one axis
};

/// `verticals` are those of `maps`, which were built from `odometry`. The first pose stays.
[[nodiscard]] Levelling level_odometry(const Trajectory& odometry,
                                       const std::vector<LocalMapRecord>& maps,
                                       const std::vector<MapVertical>& verticals,
                                       const OdometryInformationOptions& drift,
                                       const LevellingOptions& options = {});

}  // namespace groundloop
