// How sharp a map is, measured on its own: thickness of its planes, everywhere and where places
// were visited again, and mean map entropy. Cells are cubes; what a cell's points look like to a
// single visit decides whether it is a plane, so that a wall that two visits put in two places
// counts as thick and is not left out.
//
// Definitions, as `text()` prints them:
//   thickness  of a cell: root mean square distance of all its points from the plane of least
//              squares through them
//   plane      the visit with the most points in the cell (20 at least) deviates from a plane of
//   its
//              own by at most 0.1 m and a fifth of its smaller extent
//   revisited  two visits at least have 10 points each; visits are stretches of recording that do
//              not follow one another
//   entropy    mean over all points of 1/2 ln det(2 pi e C), C the covariance of the point's cell
//              plus 1 cm^2
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "backend/map/point_tiles.hpp"

namespace groundloop {

struct ThicknessFigures {
  double mean_m = 0.0, most_m = 0.0;  ///< most: 95 % of the cells stay below
  std::size_t cells = 0;
};

struct MapMeasures {
  ThicknessFigures planes, revisited;
  double entropy = 0.0;
  double judged_share = 0.0;  ///< planes, of all cells with 20 points
  std::size_t points = 0;
  double cell_m = 0.0;
};

/// Measures the points of all tiles, whose tags number the stretches of recording they come from,
/// and which were added in the order of their tags: numbers that follow one another are one visit.
/// Cells of `cell` metres; tile edges must be whole numbers of them.
[[nodiscard]] MapMeasures measure_map(const PointTiles& tiles, double cell);

/// The definitions above, for whoever reads the figures.
[[nodiscard]] const char* map_measure_definitions();

}  // namespace groundloop
