// What a pose graph's measurements say for the assumptions under which it was made: the density of
// all of them together, its poses integrated out. Graphs of the same measurements with other
// covariances, or with other closures called true, are compared by it.
#pragma once

#include "backend/graph/pose_graph.hpp"

namespace groundloop {

/// Logarithm of the integral, over all poses but one fixed in each component, of the product of the
/// normal densities of the residuals of the edges that are not rejected; Laplace's approximation at
/// the solution, from the poses given. Information of closures is bounded (closure_groups.hpp).
[[nodiscard]] double log_marginal_density(PoseGraph graph);

}  // namespace groundloop
