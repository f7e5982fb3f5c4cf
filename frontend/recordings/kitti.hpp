// The KITTI odometry layout: sequences/NN/{velodyne/*.bin, times.txt, calib.txt} with
// poses/NN.txt, and optionally sequences/NN/times_per_point/*.bin.
//
// Scans are float32 x y z intensity. Poses are of the left camera and brought to the LiDAR's frame
// with calib.txt. The elevation error of KITTI's own scans is put right by open_recording.
#pragma once

#include <filesystem>
#include <memory>

#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// The sequence folder for a path that is one, holds `sequences/`, or is `sequences`; empty where
/// the path is none of these. Throws InputError where several sequences leave the choice open.
[[nodiscard]] std::filesystem::path find_kitti_sequence(const std::filesystem::path& path);

/// T_camera_lidar of a calib.txt: its line "Tr:". Throws InputError where there is none.
[[nodiscard]] Pose read_kitti_calibration(const std::filesystem::path& file);

[[nodiscard]] std::unique_ptr<Recording> open_kitti(const std::filesystem::path& sequence,
                                                    const RecordingOptions& options = {});

}  // namespace groundloop::recordings
