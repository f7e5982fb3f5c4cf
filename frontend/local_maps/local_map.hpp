// A local map: consecutive scans put together with their odometry poses, in the frame of the first
// (Sec. 3.1 of the paper). The unit in which loops are closed.
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

struct LocalMap {
  int id = 0;
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;  ///< included
  Pose T_world_map;           ///< odometry pose of the first scan
  Points points;              ///< in the map's own frame, at most 20 a voxel of 0.5 m
};

}  // namespace groundloop
