// Trajectories and ground truth in every form (TUM, KITTI, seconds and nanoseconds apart), their
// evaluation against each other, and frames of ground truth. Two files in a row, the estimate and
// the truth, with an empty line between them; the first byte chooses what they are.
#include "frontend/core/trajectory.hpp"

#include "apps/commands/ground_truth.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/evaluation/truth_frame.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(trajectory) {
  const std::string_view text = text_of(input);
  const std::size_t end = std::min(text.find("\n\n"), text.size());
  const auto file = scratch_file("estimate.txt", text.substr(0, end));
  const auto truth_file = scratch_file("truth.txt", text.substr(std::min(end + 2, text.size())));
  const apps::GroundTruth truth = apps::read_ground_truth(truth_file, "");
  for (const StampedPose& sample : truth.poses) {
    FUZZ_PROMISE(is_stamp(sample.stamp));
    FUZZ_PROMISE(sample.pose.translation.allFinite());
  }
  Trajectory estimate = apps::read_ground_truth(file, "").poses;
  const apps::JudgedTruth judged = apps::judge_ground_truth(truth, estimate);
  (void)path_length(judged.poses);
  for (const char* alignment : {"none", "origin", "se3", "sim3"}) {
    TrajectoryEvaluationOptions options;
    options.alignment = alignment;
    try {
      (void)evaluate_trajectory(estimate, judged.poses, options);
    } catch (const InputError&) {
    }
  }
  const auto again = scratch_folder() / "again.txt";
  write_tum(again, estimate);
  FUZZ_PROMISE(read_tum(again).size() == estimate.size());
  write_kitti_poses(again, estimate);
  FUZZ_PROMISE(read_kitti_poses(again).size() == estimate.size());
}
