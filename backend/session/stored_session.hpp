// A finished session read back whole: what merging and matching start from. A merged session is the
// recordings it was made of again, joined by the closures between them. Local maps stay on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "backend/graph/pose_graph.hpp"
#include "backend/session/manifest.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/trajectory.hpp"
#include "loopclosure/loop_closure.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

/// One recording of a session. Maps and scans count from 0.
struct SessionPart {
  std::string name;
  std::string recording;  ///< where it was read from, as the manifest says
  std::string sensor;
  Trajectory odometry;    ///< one pose a scan, world: the first scan
  Trajectory trajectory;  ///< one pose a scan, optimised, in the session's frame
  std::vector<LocalMapRecord> maps;
  std::vector<MapDescription> descriptions;         ///< one a map, in their order
  std::size_t first_scan_file = 0, scan_files = 0;  ///< its kept scans, in the session's numbers
  int first_map = 0;  ///< added to a map's number it gives its id in the session's files
  std::uint64_t fingerprint = 0;  ///< of the descriptions; ties a matches file to its session
};

struct StoredSession {
  SessionFolder folder;
  std::vector<SessionPart> parts;
  PoseGraph graph;  ///< ids as in the files; edges that were given up are left out
  std::vector<ClosureRecord> closures;  ///< sessions by the parts' names, maps counted in the part
};

/// Reads manifest, trajectories, local maps' table, closures, graph and loop database, and checks
/// them, and every local map, against the manifest's checksums. Throws InputError, naming the
/// file, where the session is unfinished, of another version, damaged or cut off.
[[nodiscard]] StoredSession load_session(const std::filesystem::path& folder,
                                         const LoopClosureOptions& options);

/// The same of files that were just written and have no manifest yet: as `manifest` says, unchecked
/// but against each other. `name` is that of a session of one recording.
[[nodiscard]] StoredSession read_session(const SessionFolder& folder, const std::string& name,
                                         const Manifest& manifest,
                                         const LoopClosureOptions& options);

}  // namespace groundloop
