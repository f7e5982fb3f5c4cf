// A session as its folder has it, with everything that a report, a comparison or a diagnosis tells
// of it. The one place where they read sessions.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/config/config.hpp"
#include "apps/report/session_tables.hpp"
#include "backend/session/manifest.hpp"
#include "backend/session/stored_session.hpp"

namespace groundloop::apps {

/// Successive scans of one recording whose poses are in one frame: a recording, or a piece of one
/// that odometry lost.
struct Strand {
  std::string name;            ///< of the recording, and of the piece where it has several
  std::size_t part = 0;        ///< place of the recording in the session
  int frame = 0;               ///< strands with the same number share a world
  std::size_t first_scan = 0;  ///< in the recording
  std::size_t scans = 0;
};

struct SessionContents {
  StoredSession session;
  Config config;
  Manifest manifest;
  nlohmann::ordered_json metrics;        ///< null where there are none
  std::vector<Strand> strands;           ///< in order, covering all scans
  std::vector<std::string> frame_names;  ///< by frame
  std::vector<ScanQuality> quality;      ///< scans counted through all recordings
  std::vector<OdometryPiece> pieces;
  std::vector<ScanClosure> scan_closures;
  std::vector<MapUncertainty> uncertainty;  ///< maps by their numbers in the session's files
  std::vector<std::string> unreadable;  ///< of the tables that a session may lack: what is wrong

  [[nodiscard]] bool merged() const { return manifest.merged(); }
  /// Place of the recording called `name`. Throws InputError where there is none.
  [[nodiscard]] std::size_t part_index(const std::string& name) const;
  /// Number of the recording's first scan among all scans of the session.
  [[nodiscard]] std::size_t first_scan_of(std::size_t part) const;
};

/// Throws InputError, naming the file, where the session is unfinished, damaged or of another
/// version. What is wrong with a table that a session may lack is told in `unreadable`.
[[nodiscard]] SessionContents read_session_contents(const std::filesystem::path& folder);

/// The same of a session that is whole but for its manifest, as the command that made it has it:
/// its folder, the name it will have, and what its manifest will say.
[[nodiscard]] SessionContents read_session_contents(const SessionFolder& folder,
                                                    const std::string& name,
                                                    const Manifest& manifest, const Config& config);

}  // namespace groundloop::apps
