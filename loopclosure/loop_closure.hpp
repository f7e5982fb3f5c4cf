// The loop-closure module as the rest of groundloop sees it: describe a local map, match it against
// the database, and get closure candidates with a relative pose in SE(3) (Sec. 3 of the paper).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

/// A local map of a session. Sessions count from 0 in the order they entered a database.
struct MapKey {
  int session = 0;
  int map = 0;
  friend auto operator<=>(const MapKey&, const MapKey&) = default;
};

/// 256 bits, the ORB descriptor.
using Descriptor = std::array<std::uint64_t, 4>;

/// What the database keeps of a local map.
struct MapDescription {
  MapKey key;
  Pose T_ground_map;  ///< ground alignment (Sec. 3.2)
  double ground_quality =
      0.0;  ///< share of the occupied ground cells that support the plane, in [0, 1]
  std::vector<Eigen::Vector2f> keypoints;  ///< metres, in the ground frame
  std::vector<float> orientations;         ///< rad, in the ground frame, one a keypoint
  std::vector<Descriptor> descriptors;     ///< one a keypoint
};

/// A pair of local maps that may show the same place.
struct ClosureCandidate {
  MapKey reference;
  MapKey query;
  int matches = 0;
  int inliers = 0;         ///< after the final fit
  Pose T_query_reference;  ///< maps reference-map points into the query map (eq. 3D estimate)
};

/// Busy seconds of each stage, for metrics.json, and their squares over the maps, for deviations.
struct LoopClosureTimes {
  double ground_alignment = 0, density_image = 0, features = 0, matching = 0, consensus = 0;
  struct Squares {
    double ground_alignment = 0, detection = 0, consensus = 0;
  } squares;  ///< detection: density image, features and matching together
  /// Adds the times of one map.
  void add_map(const LoopClosureTimes& map) {
    ground_alignment += map.ground_alignment;
    density_image += map.density_image;
    features += map.features;
    matching += map.matching;
    consensus += map.consensus;
    const double detection = map.density_image + map.features + map.matching;
    squares.ground_alignment += map.ground_alignment * map.ground_alignment;
    squares.detection += detection * detection;
    squares.consensus += map.consensus * map.consensus;
  }
};

}  // namespace groundloop
