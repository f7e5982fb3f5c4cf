// Which closures agree with each other: pairwise consistency maximisation (PCM; Mangelson, Dominic,
// Eustice, Vasudevan, ICRA 2018). Two closures agree where the loop they form with the odometry
// between their ends comes back to the identity, as far as all four covariances let one say; the
// largest set of closures that agree pair by pair is a maximum clique. It works within a session
// and between two: no common frame is needed.
#pragma once

#include <functional>
#include <vector>

#include "backend/graph/relative_pose.hpp"
#include "frontend/core/options.hpp"

namespace groundloop {

/// A closure between pose `from` of one odometry and pose `to` of the other (or the same).
struct PairwiseClosure {
  int from = 0;
  int to = 0;
  RelativePose T_from_to;
};

/// Pose of `to` in `from` along an odometry, with covariance; `from` may be greater than `to`.
/// Called from several threads at once.
using ChainFunction = std::function<RelativePose(int from, int to)>;

struct ConsistencyOptions {
  double probability = 0.99;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("probability", self.probability, Range{0.5, 0.999999}, "",
          "chi-square quantile (6 degrees of freedom) below which two closures agree");
  }
};

struct ConsistentSets {
  /// Positions of closures, rising within a set. The first set is the largest clique, the next the
  /// largest among what is left, and so on; every closure is in one set, if need be alone.
  std::vector<std::vector<int>> sets;
  bool proven = true;  ///< false where the search for the first set ended at its limit
};

/// Squared Mahalanobis distance of the loop of two closures from the identity.
[[nodiscard]] double pairwise_distance(const PairwiseClosure& a, const PairwiseClosure& b,
                                       const ChainFunction& odometry_from,
                                       const ChainFunction& odometry_to);

/// Sets of closures that agree. Within a session give both chain functions the same odometry and
/// let every closure lead from the later pose to the earlier one: the loops are then short. The
/// number of pairs grows with the square of the closures; 1 000 take a second or two.
/// Deterministic for every number of threads.
[[nodiscard]] ConsistentSets consistent_sets(const std::vector<PairwiseClosure>& closures,
                                             const ChainFunction& odometry_from,
                                             const ChainFunction& odometry_to,
                                             const ConsistencyOptions& options = {});

}  // namespace groundloop
