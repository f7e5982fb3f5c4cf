// What a pose graph's measurements say for the assumptions under which it was made: the density of
// all of them together, its poses integrated out. Graphs of the same measurements with other
// covariances, or with other closures called true, are compared by it.
#pragma once

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// Logarithm of the integral, over all unknowns, one pose of each component held, of the product of
/// the normal densities of the residuals of all factors that count; Laplace's approximation at the
/// solution, from the values given. Information of closures, and where an edge leaves a direction
/// open, is bounded (relative_pose.hpp): what nobody measured is unknown, not certain.
[[nodiscard]] double log_marginal_density(PoseGraph graph);

}  // namespace groundloop
