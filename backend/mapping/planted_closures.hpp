// False closures planted among those of a run, with tight information, to test that the back end
// holds against them: random ones, groups of neighbouring maps that agree with each other, and ones
// at true places but 5 to 20 m off. Off unless asked for. In closures.csv they have the source
// `detector` and no matches.
#pragma once

#include <vector>

#include "backend/session/session.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop {

struct PlantedClosureOptions {
  int random = 0;
  int groups = 0;
  int group_size = 4;
  int near = 0;
  int seed = 1;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("random", self.random, Range{0, 100000}, "",
          "false closures between maps drawn at random, up to 50 m and at any heading; for tests "
          "of the back end, as all of this section");
    field("groups", self.groups, Range{0, 100000}, "",
          "groups of false closures between successive maps that agree with each other: one street "
          "taken for another");
    field("group_size", self.group_size, Range{2, 1000}, "", "closures of a group");
    field("near", self.near, Range{0, 100000}, "",
          "closures 5 to 20 m off, each beside one that verification accepted");
    field("seed", self.seed, Range{0, 1000000}, "", "of the draws");
  }
};

/// Adds closures that pass for verified ones to `closures`. Maps need to be more than
/// a handful for there to be pairs to draw from; else nothing is planted.
void plant_false_closures(const PlantedClosureOptions& options, const Trajectory& odometry,
                          const std::vector<LocalMapRecord>& maps,
                          std::vector<ClosureRecord>& closures);

}  // namespace groundloop
