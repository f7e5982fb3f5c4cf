// Other starts for a registration that ended in the wrong place. A prediction by constant velocity
// holds for a car at ten scans a second; key frames taken by hand come at uneven times and seven
// degrees apart, and a registration that begins so far off, with neighbours no farther than two
// voxels, ends beside the truth.
//
// The scan tells: where a registered scan lies farther from the map than scans here usually do, it
// is registered again from other predictions, each also brought near by a map of voxels several
// times as wide, with so few points that it costs next to nothing; then from turns of the last
// pose. What comes out clearly nearer to the map is taken. Before a registration distances would
// mislead: ground seen by rings lies nearest where the sensor has not moved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/odometry/scan_registration.hpp"
#include "frontend/odometry/voxel_map.hpp"

namespace groundloop {

class PoseSearch {
 public:
  struct Options {
    double scale = 5.0;   ///< edge of a voxel of the wide map, in voxels of the map
    double turn = 0.14;   ///< rad, of the turns that are tried last
    double poor = 1.11;   ///< a mean distance from the map this many times the usual is a poor fit
    double better = 1.1;  ///< by so much another result must be nearer to the map to be taken
  };

  /// voxel_size in metres, of the map that scans are registered to.
  PoseSearch(const Options& options, double voxel_size);

  /// How a scan is registered to the map from a pose on: first from afar, then finely.
  struct Stages {
    std::function<ScanRegistration(const Pose&start)> coarse, fine;
  };

  struct Found {
    ScanRegistration registration;
    double fit = 0.0;  ///< mean distance from the map over what was usual before; 0: none was yet
  };

  /// The registration from `guess`, or where that fits poorly the one that fits better. `source`:
  /// the points of the scan that distances from `map` are taken of; `map_points`: those that the
  /// map will get; `others`: further predictions; `last`: the last scan's pose; `kernel`: of the
  /// wide registration; `doubtful`: the guess is little more than one, so that the
  /// registration begins where the scan lies nearest to the map. (Not else: ground seen by rings
  /// lies nearest where the sensor has not moved.)
  [[nodiscard]] Found find(const Stages& stages, const VoxelMap& map, const Points& source,
                           const Points& map_points, const Pose& guess,
                           const std::vector<Pose>& others, const Pose& last,
                           const RegistrationKernel& kernel, bool doubtful);

  void insert(const Points& map_points, const Pose& T_world_scan);
  /// Forgets the map and what was usual in it.
  void clear();
  void remove_beyond(const Eigen::Vector3d& center, float distance);

  /// Exact state for a resumable session.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  Options options_;
  double voxel_size_;
  VoxelMap wide_map_;
  VoxelDownsampler downsampler_;
  double usual_ = 0.0;  // mean distance from the map, m
  std::size_t scans_ = 0;
  std::uint64_t fruitless_ = 0;  // searches since one that found a better start
};

}  // namespace groundloop
