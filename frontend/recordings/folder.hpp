// A folder of scans: .pcd, .ply or .bin files in natural order, with stamps beside them
// (times.txt), in their names, or assumed.
#pragma once

#include <filesystem>
#include <memory>

#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// True where the folder itself holds scan files, and for one such file.
[[nodiscard]] bool is_scan_folder(const std::filesystem::path& path);

/// A folder, or one scan. A .bin file has no header: float32 x y z intensity, unless every file's
/// length says otherwise (20 or 24 bytes a record).
[[nodiscard]] std::unique_ptr<Recording> open_folder(const std::filesystem::path& path,
                                                     const RecordingOptions& options = {});

}  // namespace groundloop::recordings
