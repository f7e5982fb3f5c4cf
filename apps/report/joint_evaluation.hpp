// Several estimates against their ground truths with one alignment: the pairs of all, under stamps
// that no two share.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "backend/evaluation/trajectory_evaluation.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::apps {

class JointPoses {
 public:
  /// The poses of `pairs` (places in the estimate and in the truth), in their order.
  void add(const Trajectory& estimate, const Trajectory& truth,
           const std::vector<std::pair<std::size_t, std::size_t>>& pairs);

  [[nodiscard]] bool empty() const { return estimates_.empty(); }
  /// One SE(3) alignment for all. Pair k of the result is the k-th that was added.
  [[nodiscard]] TrajectoryEvaluation evaluate() const;
  /// By an alignment that was found elsewhere.
  [[nodiscard]] TrajectoryEvaluation evaluate(const Alignment& alignment) const;

 private:
  Trajectory estimates_, truths_;
};

}  // namespace groundloop::apps
