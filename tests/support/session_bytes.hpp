// What two sessions must have in common, byte by byte: every file but those that hold times or
// logs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "frontend/core/checksum.hpp"

namespace groundloop::testing {

/// Checksums of a session's files by their names.
inline std::map<std::string, std::uint64_t> session_bytes(const std::filesystem::path& session) {
  namespace fs = std::filesystem;
  std::map<std::string, std::uint64_t> result;
  for (const auto& entry : fs::recursive_directory_iterator(session)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), session).string();
    if (name == "metrics.json" || name == "run.log" || name == "report.html") continue;
    result[name] = checksum_of_file(entry.path());
  }
  return result;
}

}  // namespace groundloop::testing
