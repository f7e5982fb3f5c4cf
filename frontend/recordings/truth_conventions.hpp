// Ground truth where data sets put it, and of what its poses are: each convention is a file's name
// and place, and the published transform from what it tracks to the LiDAR.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

struct FoundTruth {
  std::filesystem::path file;
  std::string dataset;   ///< whose convention; empty: a usual name, taken to be of the LiDAR
  Pose T_tracked_lidar;  ///< from the LiDAR to what the poses are of
  bool boreas = false;   ///< rows of Applanix's solution, with roll, pitch and heading
};

/// Of a recording that is a folder, or a file in one. Looked for beside it, in the folders
/// ground_truth and processed/trajectory of its own and of the two above:
/// - registered_poses.csv: Newer College, stereo (Ramezani et al., IROS 2020)
/// - gt-nc-*, gt_state_*: Newer College, multi-camera (Zhang et al., 2021)
/// - exp*_imu.txt: Hilti SLAM Challenge 2022 (Zhang et al., RA-L 2023), of the bag of that name
/// - gt-tum.txt, gt-tum.csv: Oxford Spires (Tao et al., IJRR 2025)
/// - applanix/lidar_poses.csv: Boreas (Burnett et al., IJRR 2023)
/// then the usual names (find_ground_truth), and NAME.txt, .tum, .csv of a file NAME.bag.
[[nodiscard]] std::optional<FoundTruth> find_truth(const std::filesystem::path& recording);

/// Its poses, brought to the LiDAR, with a note. Throws InputError as read_ground_truth does.
[[nodiscard]] Trajectory read_truth(const FoundTruth& truth, const std::vector<Nanoseconds>& stamps,
                                    RecordingInfo& info);

/// Both; a file that cannot be read as such is a warning, and nothing is taken.
[[nodiscard]] Trajectory truth_beside(const std::filesystem::path& recording,
                                      const std::vector<Nanoseconds>& stamps, RecordingInfo& info);

}  // namespace groundloop::recordings
