// Where two local maps meet. A closure is measured between whole maps and written between their
// origins, which may lie 100 m apart; what odometry erred on the way from the origins to the place
// both maps show is part of it. Carried to the two scans that came closest there, it says what was
// measured, and goes with any other idea of the trajectory.
#pragma once

#include <cstddef>

#include "backend/graph/odometry_information.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop {

struct ClosureAnchor {
  std::size_t query_scan = 0;
  std::size_t reference_scan = 0;
  Pose T_query_reference;  ///< of the scans
};

/// `reference` and `query` are the closure's maps, built from the odometries that are given.
[[nodiscard]] ClosureAnchor anchor_closure(const Pose& T_query_reference,
                                           const LocalMapRecord& reference,
                                           const Trajectory& reference_odometry,
                                           const LocalMapRecord& query,
                                           const Trajectory& query_odometry);

/// The closure between the maps' first scans if the trajectories are as given instead.
[[nodiscard]] Pose carried_to_origins(const ClosureAnchor& anchor, const LocalMapRecord& reference,
                                      const Trajectory& reference_trajectory,
                                      const LocalMapRecord& query,
                                      const Trajectory& query_trajectory);

/// Information of the pose between the maps' first scans, from that of the closure where it was
/// measured (`information`, perturbed at the reference's first scan): less by what odometry, erring
/// by `drift`, may have lost on the ways from the first scans to those that met.
[[nodiscard]] Matrix6d information_between_origins(
    const ClosureAnchor& anchor, const Matrix6d& information, const LocalMapRecord& reference,
    const Trajectory& reference_trajectory, const LocalMapRecord& query,
    const Trajectory& query_trajectory, const OdometryInformationOptions& drift);

}  // namespace groundloop
