// What an interrupted run leaves so that --resume goes on as if nothing had happened: the state of
// odometry, the unfinished local map, and what was found so far. One versioned, checksummed file,
// and the loop database beside it.
#pragma once

#include "backend/mapping/closure_finder.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/trajectory.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/odometry.hpp"

namespace groundloop {

class Checkpoint {
 public:
  explicit Checkpoint(const SessionFolder& folder) : folder_(folder) {}

  [[nodiscard]] bool exists() const;
  void save(const Odometry& odometry, const LocalMapBuilder& builder, const ClosureFinder& finder,
            const Trajectory& trajectory) const;
  /// Throws InputError where there is no checkpoint, or where it is damaged.
  void load(Odometry& odometry, LocalMapBuilder& builder, ClosureFinder& finder,
            Trajectory& trajectory, const LoopClosureOptions& options) const;
  void remove() const;

 private:
  SessionFolder folder_;
};

}  // namespace groundloop
