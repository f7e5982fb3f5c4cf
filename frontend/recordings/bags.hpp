// Recordings in bags: ROS 1 bags, ROS 2 bags (sqlite3 or MCAP storage) and MCAP files.
#pragma once

#include <filesystem>
#include <memory>

#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// A .bag file, or a folder of them that are read together (a split bag).
[[nodiscard]] bool is_rosbag(const std::filesystem::path& path);
/// A folder with metadata.yaml, .db3 files or their zstd-compressed form; or one .db3 file.
[[nodiscard]] bool is_rosbag2(const std::filesystem::path& path);
/// An .mcap file, or a folder of them.
[[nodiscard]] bool is_mcap(const std::filesystem::path& path);

/// All read `path` and options.more_paths in time order. Throw InputError listing the topics with
/// types, counts and rates where none or several hold PointCloud2 and options.topic does not
/// choose.
[[nodiscard]] std::unique_ptr<Recording> open_rosbag(const std::filesystem::path& path,
                                                     const RecordingOptions& options);
[[nodiscard]] std::unique_ptr<Recording> open_rosbag2(const std::filesystem::path& path,
                                                      const RecordingOptions& options);
[[nodiscard]] std::unique_ptr<Recording> open_mcap(const std::filesystem::path& path,
                                                   const RecordingOptions& options);

}  // namespace groundloop::recordings
