// A cloud in levels of detail, as a browser wants it: level 0 is a coarse picture of the whole, and
// each further level halves the spacing and adds to those before it. The points of a level lie in
// cubes that can be drawn or left out one by one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "apps/report/point_sampler.hpp"

namespace groundloop::apps {

/// Consecutive points of one level in one cube.
struct OctreeNode {
  int level = 0;      ///< 0 is the coarsest
  float edge = 0.0F;  ///< of the cube, m
  Eigen::Vector3f corner = Eigen::Vector3f::Zero();
  std::size_t first = 0;
  std::size_t count = 0;
};

struct PointOctree {
  /// By node; within a node along a Morton curve, so that neighbours follow one another.
  std::vector<MapPoint> points;
  std::vector<OctreeNode> nodes;  ///< coarse levels first
  /// Distance of the points of a level, with those of the levels before, m.
  [[nodiscard]] float spacing(int level) const;
  float coarsest_spacing = 0.0F;
  int levels = 0;
};

/// `points` are one a voxel of `spacing` m, as a PointSampler leaves them. Of more than `most`
/// points some of the finest level are left out, evenly.
[[nodiscard]] PointOctree build_octree(const std::vector<MapPoint>& points, float spacing,
                                       std::size_t most);

}  // namespace groundloop::apps
