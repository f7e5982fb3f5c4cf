// Where the registration of a scan begins. A prediction holds for a car at ten scans a second; key
// frames taken by hand come at uneven times and seven degrees apart, and a registration that begins
// so far off, with neighbours no farther than two voxels, ends beside the truth.
//
// So several predictions are tried, and the one at which the scan lies nearest to the map is taken:
// the scan tells, no memory of which rule held of late is needed. Where none fits as scans here
// usually do, each is registered first to a map of voxels several times as wide, with so few points
// that it costs next to nothing; and if that does not do either, turns of the last pose are tried.
#pragma once

#include <cstddef>
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
    double scale = 5.0;  ///< edge of a voxel of the wide map, in voxels of the map
    double turn = 0.14;  ///< rad, of the turns that are tried last
    double poor = 1.3;   ///< a mean distance from the map this many times the usual is a poor fit
  };

  /// voxel_size in metres, of the map that scans are registered to.
  PoseSearch(const Options& options, double voxel_size);

  /// The start for `source`, points of the scan that is to be registered to `map`. `predictions`:
  /// poses to try, the likeliest first (one at least); `last`: the last scan's. `map_points`: those
  /// that the map will get.
  [[nodiscard]] Pose find(const VoxelMap& map, const Points& source, const Points& map_points,
                          const std::vector<Pose>& predictions, const Pose& last,
                          const RegistrationKernel& kernel);

  /// What find() judges by: the mean distance from the map of a scan that was registered, m.
  void learn(const VoxelMap& map, const Points& source, const Pose& registered);

  void insert(const Points& map_points, const Pose& T_world_scan);
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
};

}  // namespace groundloop
