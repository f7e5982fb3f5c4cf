#include "apps/commands/session_pieces.hpp"

#include <algorithm>
#include <filesystem>

#include "backend/session/manifest.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

// How the local maps of a session lie: bent as its trajectory says, or, where a session holds no
// trajectories, each at its one pose.
class Layout {
 public:
  Layout(const SessionFolder& session, const std::vector<LocalMapRecord>& maps)
      : session_(session) {
    const fs::path odometry = session.file("odometry.tum");
    const fs::path trajectory = session.file("trajectory.tum");
    if (!fs::exists(odometry) || !fs::exists(trajectory)) return;
    odometry_ = read_tum(odometry);
    trajectory_ = read_tum(trajectory);
    for (const LocalMapRecord& map : maps) {
      if (map.first_scan <= map.last_scan &&
          map.last_scan < std::min(odometry_.size(), trajectory_.size()))
        continue;
      throw InputError(session.file("local_maps.csv").string() + ": map " +
                       std::to_string(map.map) +
                       " holds scans that odometry.tum or trajectory.tum do not; make the session "
                       "again");
    }
  }

  [[nodiscard]] MapPiece piece(const LocalMapRecord& map, std::uint16_t recording) const {
    const fs::path file = session_.local_map(map.map);
    if (trajectory_.empty()) return rigid_piece(file, map.T_world_map, recording);
    return bent_piece(file, map, odometry_, trajectory_, recording);
  }

 private:
  const SessionFolder& session_;
  Trajectory odometry_, trajectory_;
};

}  // namespace

SessionPieces pieces_of(const SessionFolder& session) {
  if (!fs::exists(session.file("local_maps.csv"))) {
    throw InputError(session.path().string() +
                     ": is no session (local_maps.csv is missing); give a folder that `groundloop "
                     "run` or `merge` has finished");
  }
  SessionPieces result;
  const std::vector<LocalMapRecord> maps = read_local_maps(session.file("local_maps.csv"));
  const Layout layout(session, maps);
  const Manifest manifest = has_manifest(session) ? read_complete_manifest(session) : Manifest();
  if (!manifest.merged()) {
    for (const LocalMapRecord& map : maps) result.pieces.push_back(layout.piece(map, 0));
    return result;
  }
  result.sessions = manifest.parts.size();
  for (std::size_t p = 0; p < manifest.parts.size(); ++p) {
    const ManifestPart& part = manifest.parts[p];
    if (part.frame != manifest.parts.front().frame) {
      result.apart.push_back(part.name);
      continue;
    }
    const auto first = static_cast<int>(part.first_map);
    const int last = first + static_cast<int>(part.local_maps);
    for (const LocalMapRecord& map : maps) {
      if (map.map < first || map.map >= last) continue;
      result.pieces.push_back(layout.piece(map, static_cast<std::uint16_t>(p)));
    }
  }
  return result;
}

}  // namespace groundloop::apps
