#include "apps/commands/session_pieces.hpp"

#include <algorithm>
#include <filesystem>

#include "backend/session/manifest.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

// The tables of a session that say how its files lie.
struct Tables {
  std::vector<LocalMapRecord> maps;
  Trajectory odometry, trajectory;
};

Tables read_tables(const SessionFolder& session) {
  if (!fs::exists(session.file("local_maps.csv"))) {
    throw InputError(session.path().string() +
                     ": is no session (local_maps.csv is missing); give a folder that `groundloop "
                     "run` or `merge` has finished");
  }
  Tables tables{read_local_maps(session.file("local_maps.csv")), {}, {}};
  // Without trajectories local maps lie at their one pose each.
  const fs::path odometry = session.file("odometry.tum");
  const fs::path trajectory = session.file("trajectory.tum");
  if (!fs::exists(odometry) || !fs::exists(trajectory)) return tables;
  tables.odometry = read_tum(odometry);
  tables.trajectory = read_tum(trajectory);
  for (const LocalMapRecord& map : tables.maps) {
    if (map.first_scan <= map.last_scan &&
        map.last_scan < std::min(tables.odometry.size(), tables.trajectory.size()))
      continue;
    throw InputError(session.file("local_maps.csv").string() + ": map " + std::to_string(map.map) +
                     " holds scans that odometry.tum or trajectory.tum do not; make the session "
                     "again");
  }
  return tables;
}

Trajectory slice(const Trajectory& all, const ManifestPart& part) {
  const std::size_t first = std::min(part.first_scan, all.size());
  const std::size_t end = std::min(first + part.scans, all.size());
  return {all.begin() + static_cast<std::ptrdiff_t>(first),
          all.begin() + static_cast<std::ptrdiff_t>(end)};
}

// The maps of one recording, maps and scans counted in it.
std::vector<LocalMapRecord> maps_of(const SessionFolder& session, const Tables& tables,
                                    const ManifestPart& part) {
  std::vector<LocalMapRecord> maps;
  const auto first = static_cast<int>(part.first_map);
  for (LocalMapRecord map : tables.maps) {
    if (map.map < first || map.map >= first + static_cast<int>(part.local_maps)) continue;
    if (map.first_scan < part.first_scan || map.last_scan >= part.first_scan + part.scans) {
      throw InputError(session.file("local_maps.csv").string() + ": map " +
                       std::to_string(map.map) + " holds scans of another recording than '" +
                       part.name + "'; make the session again");
    }
    map.map -= first;
    map.first_scan -= part.first_scan;
    map.last_scan -= part.first_scan;
    maps.push_back(map);
  }
  return maps;
}

void add_recording(const SessionFolder& session, const RecordingLayout& layout,
                   SessionPieces& result) {
  const std::vector<MapPiece> own = recording_pieces(session, layout);
  result.pieces.insert(result.pieces.end(), own.begin(), own.end());
  const bool scans = layout.scan_files > 0 && !layout.trajectory.empty();
  result.from_local_maps += scans ? 0 : 1;
}

SessionPieces merged_pieces(const SessionFolder& session, const Tables& tables,
                            const Manifest& manifest) {
  SessionPieces result;
  result.sessions = manifest.parts.size();
  for (std::size_t p = 0; p < manifest.parts.size(); ++p) {
    const ManifestPart& part = manifest.parts[p];
    if (part.frame != manifest.parts.front().frame) {
      result.apart.push_back(part.name);
      continue;
    }
    const std::vector<LocalMapRecord> maps = maps_of(session, tables, part);
    const Trajectory odometry = slice(tables.odometry, part);
    const Trajectory trajectory = slice(tables.trajectory, part);
    add_recording(session,
                  {maps, odometry, trajectory, static_cast<int>(part.first_map),
                   part.first_scan_file, part.scan_files, static_cast<std::uint16_t>(p)},
                  result);
  }
  return result;
}

SessionPieces single_pieces(const SessionFolder& session, const Tables& tables,
                            const Trajectory& trajectory, const Manifest& manifest) {
  SessionPieces result;
  add_recording(session, {tables.maps, tables.odometry, trajectory, 0, 0, manifest.scan_files, 0},
                result);
  return result;
}

}  // namespace

SessionPieces pieces_of(const SessionFolder& session) {
  const Tables tables = read_tables(session);
  const Manifest manifest = has_manifest(session) ? read_complete_manifest(session) : Manifest();
  if (manifest.merged()) return merged_pieces(session, tables, manifest);
  return single_pieces(session, tables, tables.trajectory, manifest);
}

SessionPieces pieces_of(const SessionFolder& session, const Trajectory& trajectory) {
  const Manifest manifest = read_complete_manifest(session);
  const Tables tables = read_tables(session);
  if (manifest.merged() || trajectory.size() != tables.trajectory.size())
    throw InputError(session.path().string() + ": other poses go with a session of one recording");
  return single_pieces(session, tables, trajectory, manifest);
}

}  // namespace groundloop::apps
