// The trajectory a user takes as true, from a file or from what came with a recording: read and
// tested against the scans' stamps before the work begins, and brought to the sensor's frame once
// there is an odometry to test it by.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "backend/evaluation/truth_frame.hpp"
#include "backend/session/stored_session.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

struct GroundTruth {
  Trajectory poses;  ///< as they were read, in a frame of `frames`; empty where there is none
  std::string source;
  /// Frames they may be in; the first stands unless the motion says otherwise.
  std::vector<FrameCandidate> frames;
  bool frame_given = false;  ///< by --truth-frame: the only one
  bool stamped = true;       ///< false for rows without stamps
};

/// Ground truth that the motion was compared with.
struct JudgedTruth {
  Trajectory poses;  ///< of the sensor
  TruthFrame frame;
  double instant_s = 0.0;  ///< see judge_truth_instant
  bool trusted = true;     ///< false where it fits the odometry in no frame
};

/// What --truth-frame says: empty, "sensor", "camera" (by the calib.txt found), or a file with
/// T_truth_sensor as a 4x4 (or 3x4) matrix. Reads `file` (8 columns TUM, 9, 12 KITTI with one row a
/// scan of the recording or of the whole of which it is a part). Throws InputError where the file
/// cannot be read, the frame is not to be had, or no pose lies at a scan's stamp.
[[nodiscard]] GroundTruth read_ground_truth(const std::filesystem::path& file,
                                            const std::string& truth_frame,
                                            const Recording& recording);
/// The same for a trajectory that nothing is known of but its file; rows without stamps are
/// numbered by one nanosecond each.
[[nodiscard]] GroundTruth read_ground_truth(const std::filesystem::path& file,
                                            const std::string& truth_frame);
/// What came with the recording: in the sensor's frame, as its reader knows it. One whose stamps do
/// not fit is left out with a warning.
[[nodiscard]] GroundTruth own_ground_truth(const Recording& recording);

/// Of a recording of a session: what `file` holds or, where that is empty, what came with the
/// recording; nothing where the recording is not to be had any more.
[[nodiscard]] GroundTruth ground_truth_of(const SessionPart& part,
                                          const std::filesystem::path& file,
                                          const std::string& truth_frame);

/// Of every recording of a session, brought to its sensor's frame: what `files` name by recordings,
/// else what came with them. Says in the log what it was taken for.
[[nodiscard]] std::vector<Trajectory> true_trajectories(
    const StoredSession& session, const std::map<std::string, std::filesystem::path>& files = {},
    const std::string& truth_frame = "");

/// Judges frame and instant against the sensor's odometry.
[[nodiscard]] JudgedTruth judge_ground_truth(const GroundTruth& truth, const Trajectory& odometry);

/// Says in the log what the truth was taken for, with a warning where it is not what it seemed.
void log_ground_truth(const GroundTruth& truth, const JudgedTruth& judged);

}  // namespace groundloop::apps
