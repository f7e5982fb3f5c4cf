#include "apps/report/joint_evaluation.hpp"

namespace groundloop::apps {

void JointPoses::add(const Trajectory& estimate, const Trajectory& truth,
                     const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
  constexpr Nanoseconds kApart = 1'000'000'000;
  for (const auto& [scan, row] : pairs) {
    const Nanoseconds stamp = static_cast<Nanoseconds>(estimates_.size()) * kApart;
    estimates_.push_back({stamp, estimate[scan].pose});
    truths_.push_back({stamp, truth[row].pose});
  }
}

TrajectoryEvaluation JointPoses::evaluate() const {
  return evaluate_trajectory(estimates_, truths_);
}

TrajectoryEvaluation JointPoses::evaluate(const Alignment& alignment) const {
  Trajectory aligned = estimates_;
  for (StampedPose& p : aligned) p.pose = alignment.pose * p.pose;
  TrajectoryEvaluationOptions options;
  options.alignment = "none";
  return evaluate_trajectory(aligned, truths_, options);
}

}  // namespace groundloop::apps
