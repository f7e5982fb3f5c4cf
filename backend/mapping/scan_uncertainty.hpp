// The solved graph of a stored session with every scan as a vertex, from which the covariance of
// any scan, and between any two, is read (marginals.hpp).
#pragma once

#include "backend/graph/odometry_information.hpp"
#include "backend/graph/pose_graph.hpp"
#include "backend/session/stored_session.hpp"

namespace groundloop {

/// Vertices are scans, numbered through the recordings. Between the first scans of successive maps
/// stand the steps of odometry, each with `drift` times what the session's graph says of the whole
/// way; closures stand where the session's graph has them. All are about the solution, so that
/// nothing is left to be solved.
[[nodiscard]] PoseGraph graph_of_scans(const StoredSession& session,
                                       const OdometryInformationOptions& drift);

}  // namespace groundloop
