// Everything of a run that grows while its scans come in.
#pragma once

#include <cstdint>
#include <vector>

#include "backend/mapping/closure_finder.hpp"
#include "backend/mapping/scan_keeper.hpp"
#include "backend/mapping/stage_times.hpp"
#include "frontend/core/trajectory.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/odometry.hpp"

namespace groundloop {

struct RunState {
  Odometry odometry;
  LocalMapBuilder builder;
  ClosureFinder finder;
  ScanKeeper keeper;
  Trajectory trajectory;             ///< by odometry, one pose a scan
  std::vector<ScanQuality> quality;  ///< one a scan
  std::uint64_t unusable_scans = 0;  ///< that could not be read, and whose poses were predicted
  StageTimes times;                  ///< of all calls that worked on the session
  bool scans_finished = false;       ///< every scan is registered, the last map finished
};

}  // namespace groundloop
