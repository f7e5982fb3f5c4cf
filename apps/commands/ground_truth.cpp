#include "apps/commands/ground_truth.hpp"

#include <algorithm>
#include <memory>

#include <spdlog/spdlog.h>

#include "backend/evaluation/trajectory_evaluation.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/ground_truth.hpp"
#include "frontend/recordings/kitti.hpp"
#include "frontend/recordings/source_tools.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

// T_truth_sensor of a file: a 4x4 or 3x4 matrix, whatever the line breaks.
Pose read_frame(const fs::path& file) {
  const recordings::NumberTable table = recordings::read_numbers(file);
  std::vector<double> values;
  for (const std::vector<double>& row : table.rows)
    values.insert(values.end(), row.begin(), row.end());
  if (values.size() != 16 && values.size() != 12) {
    throw InputError(file.string() + ": " + std::to_string(values.size()) +
                     " numbers; a frame is a 4x4 matrix T_truth_sensor, row by row");
  }
  double rows[12];
  std::copy_n(values.begin(), 12, rows);
  return recordings::pose_from_matrix(rows, file.string() + ": ");
}

// calib.txt of the KITTI sequence whose poses a file of the layout holds: beside it, or in
// ../sequences/NAME for poses/NAME.txt.
fs::path calibration_beside(const fs::path& truth) {
  const fs::path folder = truth.has_parent_path() ? truth.parent_path() : fs::path(".");
  std::error_code error;
  for (const fs::path& file :
       {folder / "calib.txt", folder / ".." / "sequences" / truth.stem() / "calib.txt"}) {
    if (fs::is_regular_file(file, error)) return file.lexically_normal();
  }
  return {};
}

FrameCandidate camera_of(const fs::path& calibration) {
  return {"camera, by " + calibration.string(), recordings::read_kitti_calibration(calibration)};
}

// Poses beside a calib.txt are the camera's, as KITTI has it; with no more than the recording's own
// calib.txt to go by they may be.
std::vector<FrameCandidate> frames_of(const fs::path& truth, const std::string& asked,
                                      const fs::path& recording) {
  const FrameCandidate sensor{"sensor", Pose()};
  std::error_code error;
  const fs::path beside = calibration_beside(truth);
  const fs::path own = recording / "calib.txt";
  const fs::path calibration = beside.empty() && fs::is_regular_file(own, error) ? own : beside;
  if (asked == "sensor") return {sensor};
  if (asked == "camera") {
    if (calibration.empty()) {
      throw InputError("--truth-frame camera: no calib.txt lies beside " + truth.string() +
                       "; give the file of a 4x4 matrix T_truth_sensor instead");
    }
    return {camera_of(calibration)};
  }
  if (!asked.empty()) return {{asked, read_frame(asked)}};
  if (!beside.empty()) return {camera_of(beside), sensor};
  if (!calibration.empty()) return {sensor, camera_of(calibration)};
  return {sensor};
}

std::vector<Nanoseconds> stamps_of(const Recording& recording) {
  std::vector<Nanoseconds> stamps;
  for (std::size_t i = 0; i < recording.size(); ++i) stamps.push_back(recording.stamp(i));
  return stamps;
}

// Rows without stamps: one a scan that is used, or one a scan of the whole recording.
Trajectory read_rows(const fs::path& file, const Recording& recording) {
  const std::vector<Pose> poses = read_kitti_poses(file);
  const RecordingInfo& info = recording.info();
  std::size_t first = 0;
  if (poses.size() != recording.size()) {
    if (poses.size() != info.scans_in_all) {
      throw InputError(file.string() + ": " + std::to_string(poses.size()) + " poses for " +
                       std::to_string(recording.size()) +
                       " scans; ground truth without stamps needs one row a scan");
    }
    first = info.first_scan;
  }
  Trajectory trajectory;
  for (std::size_t i = 0; i < recording.size(); ++i)
    trajectory.push_back({recording.stamp(i), poses[first + i]});
  return trajectory;
}

// Scans with a true pose at their stamp.
std::size_t scans_met(const Recording& recording, const Trajectory& truth) {
  Trajectory scans;
  for (const Nanoseconds stamp : stamps_of(recording)) scans.push_back({stamp, Pose()});
  return associate(scans, truth, TrajectoryEvaluationOptions().tolerance).size();
}

std::string span_text(const Trajectory& truth) {
  const auto [first, last] = std::minmax_element(
      truth.begin(), truth.end(),
      [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
  return seconds_text(first->stamp) + " to " + seconds_text(last->stamp) + " s";
}

std::string no_overlap(const Recording& recording, const Trajectory& truth) {
  return "no pose lies at a scan's stamp: the scans are from " + seconds_text(recording.stamp(0)) +
         " to " + seconds_text(recording.stamp(recording.size() - 1)) + " s, the poses from " +
         span_text(truth);
}

double median_step(const Trajectory& odometry) {
  std::vector<Nanoseconds> stamps;
  for (const StampedPose& pose : odometry) stamps.push_back(pose.stamp);
  return 1e-9 * static_cast<double>(recordings::scan_duration(stamps));
}

}  // namespace

GroundTruth read_ground_truth(const fs::path& file, const std::string& truth_frame,
                              const Recording& recording) {
  GroundTruth truth;
  truth.source = file.string();
  truth.frames = frames_of(file, truth_frame, recording.info().path);
  truth.frame_given = !truth_frame.empty();
  truth.stamped = recordings::read_numbers(file).columns != 12;
  truth.poses = truth.stamped ? recordings::read_ground_truth(file, stamps_of(recording))
                              : read_rows(file, recording);
  if (scans_met(recording, truth.poses) == 0)
    throw InputError(file.string() + ": " + no_overlap(recording, truth.poses));
  return truth;
}

GroundTruth read_ground_truth(const fs::path& file, const std::string& truth_frame) {
  GroundTruth truth;
  truth.source = file.string();
  truth.frames = frames_of(file, truth_frame, {});
  truth.frame_given = !truth_frame.empty();
  truth.stamped = recordings::read_numbers(file).columns != 12;
  if (truth.stamped) {
    truth.poses = recordings::read_ground_truth(file, {});
  } else {
    for (const Pose& pose : read_kitti_poses(file))
      truth.poses.push_back({static_cast<Nanoseconds>(truth.poses.size()), pose});
  }
  return truth;
}

GroundTruth own_ground_truth(const Recording& recording) {
  GroundTruth truth;
  truth.source = "what came with the recording";
  truth.frames = {{"sensor", Pose()}};
  truth.poses = recording.ground_truth();
  if (!truth.poses.empty() && scans_met(recording, truth.poses) == 0) {
    spdlog::warn("ground truth: {} is left out: {}", truth.source,
                 no_overlap(recording, truth.poses));
    truth.poses.clear();
  }
  return truth;
}

GroundTruth ground_truth_of(const SessionPart& part, const fs::path& file,
                            const std::string& truth_frame) {
  std::unique_ptr<Recording> recording;
  try {
    recording = open_any_recording(part.recording);
  } catch (const InputError& e) {
    spdlog::debug("no ground truth from '{}': {}", part.name, e.what());
  }
  if (file.empty()) return recording ? own_ground_truth(*recording) : GroundTruth();
  return recording ? read_ground_truth(file, truth_frame, *recording)
                   : read_ground_truth(file, truth_frame);
}

std::vector<Trajectory> true_trajectories(const StoredSession& session,
                                          const std::map<std::string, fs::path>& files,
                                          const std::string& truth_frame) {
  std::vector<Trajectory> trajectories;
  for (const SessionPart& part : session.parts) {
    const auto file = files.find(part.name);
    const GroundTruth truth =
        ground_truth_of(part, file == files.end() ? fs::path() : file->second, truth_frame);
    trajectories.emplace_back();
    if (truth.poses.empty()) continue;
    JudgedTruth judged = judge_ground_truth(truth, part.odometry);
    log_ground_truth(truth, judged);
    trajectories.back() = std::move(judged.poses);
  }
  return trajectories;
}

JudgedTruth judge_ground_truth(const GroundTruth& truth, const Trajectory& odometry) {
  JudgedTruth judged;
  std::vector<Pose> estimated;
  std::vector<Pose> true_poses;
  for (const auto& [i, j] :
       associate(odometry, truth.poses, TrajectoryEvaluationOptions().tolerance)) {
    estimated.push_back(odometry[i].pose);
    true_poses.push_back(truth.poses[j].pose);
  }
  judged.frame = judge_truth_frame(estimated, true_poses, truth.frames, !truth.frame_given);
  judged.poses = in_sensor_frame(truth.poses, judged.frame.T_truth_sensor);
  if (truth.stamped && judged.frame.told && judged.frame.fits)
    judged.instant_s = judge_truth_instant(odometry, judged.poses, median_step(odometry));
  judged.trusted = judged.frame.fits;
  return judged;
}

void log_ground_truth(const GroundTruth& truth, const JudgedTruth& judged) {
  const TruthFrame& frame = judged.frame;
  if (!frame.told) {
    spdlog::info("ground truth: {}, frame '{}'; the way is too short to test it", truth.source,
                 frame.name);
    return;
  }
  if (frame.found) {
    const Pose& X = frame.T_truth_sensor;
    spdlog::warn(
        "ground truth: {} is not of the sensor: it is turned by {:.2f} degrees and {:.2f} {:.2f} "
        "{:.2f} m away from it, as the motion says (within {:.2g} degrees and {:.2g} m); compared "
        "after bringing it there; --truth-frame overrules",
        truth.source, rotation_angle(X.rotation) * 180.0 / M_PI, X.translation.x(),
        X.translation.y(), X.translation.z(), frame.rotation_deviation_deg,
        frame.lever_deviation_m);
  } else {
    spdlog::info("ground truth: {}, poses of the {}", truth.source, frame.name);
  }
  if (!frame.fits) {
    spdlog::warn(
        "ground truth: {} does not fit the odometry {} ({:.0f} % of the way and {:.0f} degrees "
        "over some metres): {}; errors against it mean little",
        truth.source, truth.frame_given ? "in the frame asked for" : "in any frame",
        frame.disagreement_percent, frame.disagreement_deg,
        truth.frame_given ? "leave --truth-frame away to have the frame found"
                          : "it is of another recording, or odometry is lost");
  }
  if (judged.instant_s != 0.0) {
    spdlog::warn(
        "ground truth: {} fits the scans best {:+.3f} s from their stamps: it may name another "
        "instant of a scan (start, middle or end); compared at the stamps",
        truth.source, judged.instant_s);
  }
}

}  // namespace groundloop::apps
