// Is the map sharper where it was seen twice, after closing loops than before? A few pairs of local
// maps that overlap, by odometry or in the solution, are measured at both poses (map_quality.hpp).
// A pair that shares nothing at one of them counts as badly aligned there, so that a solution gains
// nothing by pulling places apart.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "backend/mapping/map_quality.hpp"
#include "backend/registration/ground_footprint.hpp"
#include "backend/session/map_store.hpp"
#include "frontend/core/options.hpp"

namespace groundloop {

struct MapQualityOptions {
  int pairs = 5;
  double max_loss = 0.05;
  bool keep_worse = false;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("pairs", self.pairs, Range{0, 10000}, "",
          "overlapping pairs of local maps that are measured before and after closing loops; each "
          "takes about a tenth of a second; 0: none");
    field("max_loss", self.max_loss, Range{0.0, 10.0}, "",
          "share by which surfaces at revisits may be thicker than before; beyond it the result is "
          "called worse");
    field("keep_worse", self.keep_worse, OnOff{}, "",
          "write the solution even where it is worse; else its closures are given up and the "
          "trajectory is the odometry, with a warning");
  }
};

/// Means over the pairs, at the poses before and after.
struct MapQuality {
  std::size_t pairs = 0;  ///< measured; 0: no revisits, nothing else means anything
  RevisitQuality before, after;
  bool worse = false;     ///< thicker than before by more than max_loss
  bool given_up = false;  ///< the solution was replaced by odometry
  double seconds = 0.0;
};

/// T_query_reference of two maps, by their ids.
using RelativePoses = std::function<Pose(int reference, int query)>;

/// Pairs are drawn evenly from those of which a
/// fifth of the smaller ground area is shared at one of the poses, in the maps' order.
[[nodiscard]] MapQuality compare_revisits(std::span<const GroundFootprint> footprints,
                                          const RelativePoses& before, const RelativePoses& after,
                                          MapStore& store, const MapQualityOptions& options);

}  // namespace groundloop
