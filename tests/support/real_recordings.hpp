// The other real recordings for tests: unpacked once into the build, absent where the shared data
// are. One test at a time may ask for them.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace groundloop::testing {

/// Folder of the unpacked recordings; empty where they are absent (the caller skips by name).
inline std::filesystem::path real_recordings() {
  namespace fs = std::filesystem;
  const fs::path shared = GROUNDLOOP_SHARED_DATA;
  std::error_code error;
  if (!fs::exists(shared / "real_recordings.tar.xz", error)) return {};
  const fs::path folder = fs::path(GROUNDLOOP_TEST_WORK) / "real_recordings";
  const std::string command =
      "'" + (shared / "unpack.sh").string() + "' --real '" + folder.string() + "' >/dev/null";
  if (std::system(command.c_str()) != 0) return {};
  return folder / "real";
}

}  // namespace groundloop::testing
