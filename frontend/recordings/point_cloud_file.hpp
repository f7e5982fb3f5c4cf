// One point cloud of somebody else's making, as a file that describes its own fields.
#pragma once

#include <filesystem>

#include "frontend/core/scan.hpp"

namespace groundloop {

/// Points of a .pcd or .ply file, metres; those that are not finite are dropped. Throws InputError
/// naming the file where it is neither, is damaged, or holds no point.
[[nodiscard]] Points read_point_cloud(const std::filesystem::path& file);

}  // namespace groundloop
