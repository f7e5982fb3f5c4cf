// How sharp the map is where it was seen twice: two figures over the part that two local maps
// share, to be compared before and after closing loops. They need no ground truth.
#pragma once

#include <cstddef>

#include "backend/registration/registration.hpp"

namespace groundloop {

struct RevisitQuality {
  /// Mean distance of the reference map's cells (0.5 m) to the query map's surfaces, m. Cells in
  /// space that the query has seen (4 m cells) but without a surface within reach count 0.5 m, so
  /// that a pose gains nothing by leaving the other map's surfaces.
  double plane_thickness = 0.0;
  /// Mean map entropy (Droeschel et al. 2014): mean of 1/2 ln |2 pi e C| over the 1 m cells that
  /// hold points of both maps, C the covariance of all points in the cell, m^2. Lower is sharper.
  double entropy = 0.0;
  std::size_t cells = 0;          ///< that the thickness is the mean of
  std::size_t entropy_cells = 0;  ///< that the entropy is the mean of
};

/// `query` are the points `query_target` was built from; the pose maps reference-map points into
/// the query map. All 0 where the maps share nothing.
[[nodiscard]] RevisitQuality revisit_quality(const RegistrationTarget& query_target,
                                             const Points& query, const Points& reference,
                                             const Pose& T_query_reference);

/// Several pairs as one: means weighted by cells.
[[nodiscard]] RevisitQuality combine(const RevisitQuality& a, const RevisitQuality& b);

}  // namespace groundloop
