// Closures that stand or fall together: neighbours along both ways that agree with each other over
// the short odometry between them. A place that looks like another gives false closures in groups,
// as a place visited twice gives true ones, so that the agreement of neighbours says little about
// whether a group is true; what it says about odometry on the short way between them is counted.
#pragma once

#include <vector>

#include "backend/graph/odometry_tree.hpp"
#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// Poses that a false closure may claim, m^3 rad^3: of two maps of 100 m that are taken for each
/// other, within 100 m and 3 m in height, at any heading, within 3 degrees of tilt. Its residual is
/// uniform over them, which is what makes odometry's word on a closure evidence.
inline constexpr double kFalseClosureVolume = 1e4;

struct ClosureGroups {
  std::vector<std::vector<std::size_t>> groups;  ///< positions of edges, rising within a group
  /// Logarithm of the density of each group's members given one of them.
  std::vector<double> inner_log_density;
};

/// Groups of the given edges (positions in graph.edges). Members are joined through neighbours
/// whose ends lie within `distance` metres on both ways and whose loop passes the chi-square bound.
[[nodiscard]] ClosureGroups group_closures(const PoseGraph& graph, const OdometryTree& odometry,
                                           const std::vector<std::size_t>& closures,
                                           double distance, double bound);

/// Logarithm of the probability, before odometry and other closures are asked, that the groups are
/// all true or all false, as `called_true` says.
[[nodiscard]] double log_prior(const ClosureGroups& groups, bool called_true);

/// Logarithm of the normal density of zero mean at the residual of a loop that should be the
/// identity.
[[nodiscard]] double log_density(const RelativePose& loop);

}  // namespace groundloop
