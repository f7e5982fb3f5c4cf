// Layouts of published datasets beside KITTI odometry: KITTI raw, MulRan, HeLiPR, NCLT. Each reader
// brings points to a frame with z upward and ground truth to the LiDAR.
#pragma once

#include <filesystem>
#include <memory>

#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// KITTI raw: DRIVE/velodyne_points/{data/*.bin, timestamps*.txt}; times within the turn from the
/// azimuth; ground truth from oxts with ../calib_imu_to_velo.txt.
[[nodiscard]] bool is_kitti_raw(const std::filesystem::path& path);
[[nodiscard]] std::unique_ptr<Recording> open_kitti_raw(const std::filesystem::path& path,
                                                        const RecordingOptions&);

/// MulRan: [sensor_data/]Ouster/<ns>.bin and global_pose.csv.
[[nodiscard]] bool is_mulran(const std::filesystem::path& path);
[[nodiscard]] std::unique_ptr<Recording> open_mulran(const std::filesystem::path& path,
                                                     const RecordingOptions&);

/// HeLiPR: LiDAR/SENSOR/<ns>.bin and LiDAR_GT/SENSOR_gt.txt; the path may be that of one sensor.
/// options.topic chooses where there are several. Throws InputError listing them otherwise.
[[nodiscard]] bool is_helipr(const std::filesystem::path& path);
[[nodiscard]] std::unique_ptr<Recording> open_helipr(const std::filesystem::path& path,
                                                     const RecordingOptions&);

/// NCLT: velodyne_sync/<us>.bin or velodyne_hits.bin (chosen by options.topic where both are there;
/// hits, which have times, by default), and groundtruth_*.csv.
[[nodiscard]] bool is_nclt(const std::filesystem::path& path);
[[nodiscard]] std::unique_ptr<Recording> open_nclt(const std::filesystem::path& path,
                                                   const RecordingOptions&);

/// nuScenes: a folder of v1.0-*/*.json beside samples/ and sweeps/; options.topic chooses the
/// scene.
[[nodiscard]] bool is_nuscenes(const std::filesystem::path& path);
[[nodiscard]] std::unique_ptr<Recording> open_nuscenes(const std::filesystem::path& path,
                                                       const RecordingOptions&);

}  // namespace groundloop::recordings
