// How far an estimated trajectory lies from the ground truth: absolute pose error, relative pose
// error and the segment metric of the KITTI odometry benchmark. Association, alignment and the
// definition of each figure are stated beside it, since two of the three have several in use.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "frontend/core/options.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop {

struct TrajectoryEvaluationOptions {
  std::string alignment = "se3";
  bool by_row = false;
  double tolerance = 0.01;
  double rpe_distance = 10.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("alignment", self.alignment, Choices{"none", "origin", "se3", "sim3"}, "",
          "se3: Umeyama over positions, no scale; the frame of an estimate is arbitrary");
    field("by_row", self.by_row, OnOff{}, "",
          "pairs poses by their place, for files without stamps (KITTI)");
    field("tolerance", self.tolerance, Range{0.0, 10.0}, "s",
          "largest distance of paired stamps; ground truth is often stamped by another clock");
    field("rpe_distance", self.rpe_distance, Range{0.1, 1e5}, "m",
          "way between the two poses of a relative error per distance");
  }
};

/// A similarity: p_ground_truth = scale * rotation * p_estimate + translation.
struct Alignment {
  Pose pose;
  double scale = 1.0;
};

struct Statistics {
  double rmse = 0, mean = 0, median = 0;
  double std = 0;  ///< of the population
  double min = 0, max = 0;
};

struct PoseErrorStatistics {
  std::size_t count = 0;
  Statistics translation_m;
  Statistics rotation_deg;
};

struct TrajectoryEvaluation {
  /// Places in the estimate and in the ground truth, in time order.
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  Alignment alignment;         ///< that was applied to the estimate
  double path_length_m = 0.0;  ///< of the paired ground truth

  /// APE. Translation: |p_gt - aligned(p_est)|. Rotation: angle of R_gt^T R_align R_est.
  PoseErrorStatistics ape;
  /// APE along the axes of the ground-truth frame, of the absolute differences.
  Statistics ape_x_m, ape_y_m, ape_z_m;
  /// RPE: E = (gt_i^-1 gt_j)^-1 (est_i^-1 est_j), its translation's norm and its angle; no
  /// alignment enters but the scale. j is the next pair, or the first `rpe_distance` metres on.
  PoseErrorStatistics rpe_frame;
  PoseErrorStatistics rpe_distance;
  double rpe_distance_m = 0.0;
  /// KITTI's metric: segments of 100, 200 ... 800 m of ground-truth way from every tenth pose, the
  /// error of the segment's end over its length, averaged over all segments. 0 segments: way too
  /// short.
  std::size_t kitti_segments = 0;
  double kitti_translation_percent = 0.0;
  double kitti_rotation_deg_per_m = 0.0;

  /// One a pair, for plots: ground truth minus aligned estimate (m, ground-truth axes), and
  /// degrees.
  std::vector<Eigen::Vector3d> translation_errors;
  std::vector<double> rotation_errors_deg;
};

/// Statistics of a set of numbers; all 0 where it is empty.
[[nodiscard]] Statistics statistics(std::vector<double> values);

/// Pairs each pose of the trajectory with fewer poses with the nearest stamp of the other within
/// `tolerance` seconds; a pose is used at most once and goes to the nearest partner. Neither needs
/// to be sorted.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> associate(
    const Trajectory& estimate, const Trajectory& ground_truth, double tolerance);

/// Least-squares alignment of positions (Umeyama, PAMI 1991). Where the positions lie on a line or
/// in one point the free rotation is taken from the orientations.
[[nodiscard]] Alignment align_umeyama(const std::vector<Pose>& estimate,
                                      const std::vector<Pose>& ground_truth, bool with_scale);

/// Throws InputError where no poses can be paired or, by row, the lengths differ.
[[nodiscard]] TrajectoryEvaluation evaluate_trajectory(
    const Trajectory& estimate, const Trajectory& ground_truth,
    const TrajectoryEvaluationOptions& options = {});

}  // namespace groundloop
