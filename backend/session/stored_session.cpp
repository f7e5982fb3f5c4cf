#include "backend/session/stored_session.hpp"

#include <algorithm>
#include <span>

#include "backend/session/manifest.hpp"
#include "backend/session/session_graph.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

// Every file that is read here, by what the manifest says of it.
void check_files(const SessionFolder& folder, const Manifest& manifest) {
  const auto check_file = [&](const std::string& name) {
    const auto sum = manifest.checksums.find(name);
    if (sum == manifest.checksums.end())
      fail(folder.file("manifest.json"), "has no checksum of " + name + "; make the session again");
    if (!fs::exists(folder.file(name))) fail(folder.file(name), "missing; make the session again");
    if (sum->second != hex(checksum_of_file(folder.file(name)))) {
      fail(folder.file(name),
           "differs from the manifest's checksum, so it is damaged; make the session again");
    }
  };
  for (const char* name : {"odometry.tum", "trajectory.tum", "closures.csv", "pose_graph.g2o",
                           "local_maps.csv", "loop_database.bin"})
    check_file(name);
  // As many as the manifest counts, which may be more than there can be: the first missing one ends
  // it.
  for (std::size_t m = 0; m < manifest.local_maps; ++m)
    check_file("local_maps/" + folder.local_map(static_cast<int>(m)).filename().string());
  for (std::size_t n = 0; n < manifest.scan_files; ++n)
    check_file("scans/" + folder.scan_file(n).filename().string());
}

// The recordings of a session; one that is not merged has itself as its only part.
std::vector<ManifestPart> parts_of(const std::string& name, const Manifest& manifest) {
  if (manifest.merged()) return manifest.parts;
  ManifestPart part;
  part.name = name;
  part.recording = manifest.recording.at("path").get<std::string>();
  part.sensor = manifest.sensor;
  part.scans = manifest.scans;
  part.local_maps = manifest.local_maps;
  part.scan_files = manifest.scan_files;
  return {part};
}

Trajectory slice(const Trajectory& all, const ManifestPart& span) {
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(span.first_scan);
  return {first, first + static_cast<std::ptrdiff_t>(span.scans)};
}

// Maps partition the scans: nothing downstream checks indices again.
void check_partition(const fs::path& file, const SessionPart& part) {
  std::size_t next = 0;
  for (std::size_t m = 0; m < part.maps.size(); ++m) {
    const LocalMapRecord& map = part.maps[m];
    if (map.map != static_cast<int>(m) || map.first_scan != next || map.last_scan < next ||
        map.last_scan >= part.trajectory.size())
      fail(file, "map " + std::to_string(map.map) + " does not follow the one before");
    next = map.last_scan + 1;
  }
  if (part.maps.empty() || next != part.trajectory.size())
    fail(file, "the maps do not cover the scans of the trajectory");
}

SessionPart make_part(const SessionFolder& folder, const ManifestPart& span,
                      const Trajectory& odometry, const Trajectory& trajectory,
                      const std::vector<LocalMapRecord>& maps) {
  SessionPart part;
  part.name = span.name;
  part.recording = span.recording;
  part.sensor = span.sensor;
  part.first_map = static_cast<int>(span.first_map);
  part.first_scan_file = span.first_scan_file;
  part.scan_files = span.scan_files;
  part.odometry = slice(odometry, span);
  part.trajectory = slice(trajectory, span);
  for (std::size_t m = 0; m < span.local_maps; ++m) {
    LocalMapRecord map = maps[span.first_map + m];
    if (map.map != static_cast<int>(span.first_map + m) || map.first_scan < span.first_scan ||
        map.last_scan < map.first_scan)
      fail(folder.file("local_maps.csv"), "maps are not numbered in order");
    map.map = static_cast<int>(m);
    map.first_scan -= span.first_scan;
    map.last_scan -= span.first_scan;
    part.maps.push_back(map);
  }
  check_partition(folder.file("local_maps.csv"), part);
  return part;
}

std::uint64_t fingerprint(const std::vector<MapDescription>& descriptions) {
  Checksum sum;
  for (const MapDescription& d : descriptions) {
    sum.add(std::as_bytes(std::span(d.descriptors)));
    sum.add(std::as_bytes(std::span(d.keypoints)));
  }
  return sum.value();
}

// Closures name maps and recordings of the session. One of a single recording names none; it is
// called by the folder here, which may have been renamed since.
void check_closures(StoredSession& session) {
  const fs::path file = session.folder.file("closures.csv");
  const bool merged = session.parts.size() > 1;
  const auto check_side = [&](std::size_t row, std::string& name, int map) {
    const std::string line = file.string() + ":" + std::to_string(row + 2) + ": ";
    if (!merged) {
      if (!name.empty())
        throw InputError(line + "names a session, '" + name + "', in a session of one recording");
      name = session.parts.front().name;
    }
    const auto part = std::find_if(session.parts.begin(), session.parts.end(),
                                   [&](const SessionPart& p) { return p.name == name; });
    if (part == session.parts.end())
      throw InputError(line + "the manifest lists no session '" + name + "'");
    if (map < 0 || map >= static_cast<int>(part->maps.size()))
      throw InputError(line + "map " + std::to_string(map) + " does not exist");
  };
  for (std::size_t row = 0; row < session.closures.size(); ++row) {
    ClosureRecord& c = session.closures[row];
    check_side(row, c.reference_session, c.reference_map);
    check_side(row, c.query_session, c.query_map);
  }
}

// Gives each part the descriptions of its maps. A run keeps its own as session 0.
void add_descriptions(const fs::path& file, const LoopDatabase& database,
                      std::vector<SessionPart>& parts) {
  for (std::size_t p = 0; p < parts.size(); ++p) {
    SessionPart& part = parts[p];
    for (const MapDescription& d : database.descriptions()) {
      if (d.key.session == static_cast<int>(p)) part.descriptions.push_back(d);
    }
    std::sort(part.descriptions.begin(), part.descriptions.end(),
              [](const MapDescription& a, const MapDescription& b) { return a.key < b.key; });
    if (part.descriptions.size() != part.maps.size() ||
        part.descriptions.back().key.map != static_cast<int>(part.maps.size()) - 1) {
      fail(file, std::to_string(part.descriptions.size()) + " descriptions for " +
                     std::to_string(part.maps.size()) + " local maps; run the session again");
    }
    part.fingerprint = fingerprint(part.descriptions);
  }
}

// The vertices of a closure's row, query and reference.
std::vector<ClosureEnds> ends_of_accepted(const StoredSession& session) {
  const auto vertex = [&](const std::string& name, int map) {
    const auto part = std::find_if(session.parts.begin(), session.parts.end(),
                                   [&](const SessionPart& p) { return p.name == name; });
    return part->first_map + map;
  };
  std::vector<ClosureEnds> ends;
  for (const ClosureRecord& c : session.closures) {
    if (c.status != ClosureStatus::accepted) continue;
    ends.push_back(
        {vertex(c.query_session, c.query_map), vertex(c.reference_session, c.reference_map)});
  }
  return ends;
}

}  // namespace

StoredSession read_session(const SessionFolder& folder, const std::string& name,
                           const Manifest& manifest, const LoopClosureOptions& options) {
  StoredSession session{folder, {}, {}, {}};
  const Trajectory odometry = read_tum(folder.file("odometry.tum"));
  const Trajectory trajectory = read_tum(folder.file("trajectory.tum"));
  const std::vector<LocalMapRecord> maps = read_local_maps(folder.file("local_maps.csv"));
  if (odometry.size() != trajectory.size())
    fail(folder.file("odometry.tum"), "odometry and trajectory differ in length");
  if (trajectory.size() != manifest.scans || maps.size() != manifest.local_maps)
    fail(folder.file("manifest.json"), "counts other scans or local maps than the tables hold");
  for (const ManifestPart& part : parts_of(name, manifest))
    session.parts.push_back(make_part(folder, part, odometry, trajectory, maps));
  session.closures = read_closures(folder.file("closures.csv"));
  check_closures(session);
  const fs::path database = folder.file("loop_database.bin");
  add_descriptions(database, LoopDatabase::load(database, options), session.parts);
  session.graph =
      read_session_graph(folder.file("pose_graph.g2o"), maps.size(), ends_of_accepted(session));
  return session;
}

StoredSession load_session(const fs::path& path, const LoopClosureOptions& options) {
  const SessionFolder folder(path);
  const Manifest manifest = read_complete_manifest(folder);
  check_files(folder, manifest);
  if (!manifest.merged())
    check_part_name(folder.name(), folder.path().string() + ": the folder's name");
  return read_session(folder, folder.name(), manifest, options);
}

}  // namespace groundloop
