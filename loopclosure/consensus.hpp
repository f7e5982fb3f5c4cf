// Consensus between matched keypoints (Sec. 3.6): the rigid motion of the plane that most matches
// of two local maps agree with. The voting method takes every match as an anchor and so needs no
// luck: a set of inliers cannot be missed. The paper's RANSAC is kept for comparison, with the
// number of its trials derived from the probability of a miss, and seeded by the caller.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "loopclosure/loop_closure.hpp"
#include "loopclosure/options.hpp"
#include "loopclosure/planar_transform.hpp"

namespace groundloop {

/// A keypoint of the query and one of the reference with similar descriptors.
struct KeypointMatch {
  std::uint32_t query = 0;
  std::uint32_t reference = 0;
  int distance = 0;  ///< bits
};

struct Consensus {
  PlanarTransform T_query_reference;   ///< between the ground frames, fitted to all inliers
  std::vector<KeypointMatch> inliers;  ///< no keypoint appears twice
};

/// `matches` index the keypoints of the two descriptions. Without two matches there is no
/// consensus: no inliers and the identity. `seed` matters to RANSAC only.
[[nodiscard]] Consensus find_consensus(const MapDescription& query, const MapDescription& reference,
                                       std::span<const KeypointMatch> matches,
                                       const ConsensusOptions& options, std::uint64_t seed = 0);

/// Trials of two matches after which a set of `inliers` among `matches` is missed with at most this
/// probability.
[[nodiscard]] std::size_t ransac_trials(std::size_t matches, std::size_t inliers,
                                        double miss_probability);

}  // namespace groundloop
