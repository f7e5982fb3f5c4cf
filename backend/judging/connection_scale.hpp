// How much the odometries of two frames err, found from the closures between them as a session's is
// from its own (odometry_scale.hpp): at each of a row of scales the largest set of closures that
// agree pair by pair is weighed by its evidence, the frames' own closures included. A session that
// met no place twice could not tell; one whose own closures fit its odometry resists.
#pragma once

#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "backend/judging/pairwise_consistency.hpp"

namespace groundloop {

/// Two frames that are not joined. Ids of vertices are their positions; vertices of other frames
/// have no edges.
struct FramePair {
  PoseGraph graph;         ///< solved; steps are odometry, closures inside a frame closures
  std::vector<char> in_y;  ///< of each vertex: whether it belongs to the second frame
};

struct ConnectionTrial {
  double scale_x = 1.0, scale_y = 1.0;  ///< factors on the standard deviations of the steps
  ConsistentSets found;                 ///< the first set is called true, the others false
  double log_evidence = 0.0;
};

/// The pose of y in x by the closure that all others of the set agree with best. `set` holds
/// positions in `between`, whose closures lead from y (`from`) to x (`to`).
[[nodiscard]] Pose alignment_of(const PoseGraph& graph, const std::vector<PairwiseClosure>& between,
                                const std::vector<int>& set);

/// Sets at given scales, and their evidence.
[[nodiscard]] ConnectionTrial connection_at(const FramePair& frames,
                                            const std::vector<PairwiseClosure>& between,
                                            double scale_x, double scale_y,
                                            const ConsistencyOptions& options);

/// Logarithm of the likelihood ratio of a trial over both odometries: its first set true against no
/// closure true at the stated scales. Where false ones are independent, this is what agreement by
/// chance would cost; look-alike places agree as true ones do, and it says nothing about them.
[[nodiscard]] double log_likelihood_ratio(const FramePair& frames,
                                          const std::vector<PairwiseClosure>& between,
                                          const ConnectionTrial& trial,
                                          const ConsistencyOptions& options);

/// Sets at the scales of highest evidence, which are 1 or more: that odometry is better than stated
/// would take more than closures that happen to agree. Where all agree at 1, or there are fewer
/// than three, nothing else is tried. Deterministic.
[[nodiscard]] ConnectionTrial best_connection(const FramePair& frames,
                                              const std::vector<PairwiseClosure>& between,
                                              const ConsistencyOptions& options);

/// Multiplies the standard deviations of the steps of one frame (`y` 0 or 1) of the pair.
void scale_steps(PoseGraph& graph, const std::vector<char>& in_y, bool y, double scale);

}  // namespace groundloop
