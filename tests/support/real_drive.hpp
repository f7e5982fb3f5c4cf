// The real drive for tests: unpacked once into the build, absent where the shared data are.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace groundloop::testing {

/// Folder of the unpacked drive; empty where the data are absent (the caller skips by name).
inline std::filesystem::path real_drive() {
  namespace fs = std::filesystem;
  const fs::path unpack = fs::path(GROUNDLOOP_SHARED_DATA) / "unpack.sh";
  std::error_code error;
  if (!fs::exists(unpack, error)) return {};
  const fs::path folder = fs::path(GROUNDLOOP_TEST_WORK) / "real_drive";
  const std::string command = "'" + unpack.string() + "' '" + folder.string() + "' >/dev/null";
  if (std::system(command.c_str()) != 0) return {};
  return folder / "kitti_00_keyframes";
}

}  // namespace groundloop::testing
