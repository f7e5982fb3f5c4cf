// Local maps on disk: binary PCD with float x, y, z, and nothing else. Clouds of others are read by
// frontend/recordings.
#pragma once

#include <filesystem>

#include "frontend/core/scan.hpp"

namespace groundloop {

void write_pcd(const std::filesystem::path& file, const Points& points);
/// Reads what write_pcd wrote. Throws InputError naming the file where it is anything else.
[[nodiscard]] Points read_pcd(const std::filesystem::path& file);

}  // namespace groundloop
