// In which frame, and at which instant of a scan, the poses of a ground truth are: the camera's of
// KITTI, an inertial unit's, the end of the scan. A constant T_truth_sensor leaves the absolute
// error of positions nearly as it is and makes every figure of rotation and drift nonsense, so it
// is looked for before anything is judged.
//
// With A the motion of the truth's body over a stretch of way and B the sensor's, A X = X B for
// X = T_truth_sensor (hand-eye calibration; Park and Martin, T-RA 1994, is the closed form for the
// rotation used to start from).
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop {

/// A frame that the truth may be in, as a file beside it or its data set says.
struct FrameCandidate {
  std::string name;  ///< "sensor", "camera, by calib.txt", ...
  Pose T_truth_sensor;
};

struct TruthFrame {
  std::string name;
  Pose T_truth_sensor;
  bool found = false;  ///< from the motion: no candidate fits
  /// Share by which the motions over a few metres disagree, of their length, and their angle
  /// (medians), with T_truth_sensor.
  double disagreement_percent = 0.0, disagreement_deg = 0.0;
  /// Standard deviations of a found frame; about axes that the motion says nothing of they are
  /// large.
  double rotation_deviation_deg = 0.0, lever_deviation_m = 0.0;
  /// False where the motions disagree whatever the frame: another recording's truth, or odometry
  /// that is lost.
  bool fits = true;
  /// False where the way is too short or too straight to tell; then the first candidate stands.
  bool told = true;
};

/// Compares paired poses of an estimate (the sensor's) and the truth, in time order, over stretches
/// of some metres. The first candidate stands unless another, or what the motion says, explains the
/// squared disagreement four times as well. With `search` off the motion proposes no frame.
[[nodiscard]] TruthFrame judge_truth_frame(const std::vector<Pose>& estimate,
                                           const std::vector<Pose>& truth,
                                           const std::vector<FrameCandidate>& candidates,
                                           bool search = true);

/// The truth as poses of the sensor.
[[nodiscard]] Trajectory in_sensor_frame(Trajectory truth, const Pose& T_truth_sensor);

/// Seconds to add to the estimate's stamps to meet the truth, among the instants of a scan that
/// stamps are known to name: start (0), middle (half a period), end, and the same the other way
/// round. 0 unless another explains the squared disagreement at least twice as well; at constant
/// speed there is nothing to tell them by. The truth is in the sensor's frame.
[[nodiscard]] double judge_truth_instant(const Trajectory& estimate, const Trajectory& truth,
                                         double period);

/// The truth at a stamp, between its poses; at the ends the nearest. `truth` is not empty and in
/// time order.
[[nodiscard]] Pose pose_at(const Trajectory& truth, Nanoseconds stamp);

}  // namespace groundloop
