#include "backend/session/stored_session.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>

#include <nlohmann/json.hpp>

#include "backend/graph/g2o_file.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

constexpr int kSessionFormat = 1;

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

Json read_manifest(const SessionFolder& folder) {
  const fs::path file = folder.file("manifest.json");
  if (!fs::is_directory(folder.path())) fail(folder.path(), "there is no such session");
  if (!fs::exists(file)) {
    fail(folder.path(),
         "no finished session, manifest.json is missing; finish it with `groundloop run --resume`");
  }
  Json manifest;
  try {
    manifest = Json::parse(read_text(file));
    if (const int format = manifest.at("session_format").get<int>(); format != kSessionFormat) {
      fail(file, "session format " + std::to_string(format) + ", this version reads " +
                     std::to_string(kSessionFormat) + "; run the recording again");
    }
    if (manifest.at("stage").get<std::string>() != "complete")
      fail(file, "the session is unfinished; finish it with `groundloop run --resume`");
  } catch (const Json::exception&) {
    fail(file, "damaged or of another version; run the recording again");
  }
  return manifest;
}

std::string hex(std::uint64_t value) {
  std::array<char, 20> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%016llx", static_cast<unsigned long long>(value));
  return buffer.data();
}

void check_files(const SessionFolder& folder, const Json& manifest) {
  for (const auto& [name, checksum] : manifest.at("checksums").items()) {
    const bool needed = name.rfind("local_maps/", 0) == 0 || name == "odometry.tum" ||
                        name == "trajectory.tum" || name == "closures.csv" ||
                        name == "pose_graph.g2o" || name == "local_maps.csv" ||
                        name == "loop_database.bin";
    if (!needed) continue;
    if (!fs::exists(folder.file(name))) fail(folder.file(name), "missing; run the session again");
    if (checksum.get<std::string>() != hex(fnv1a_of_file(folder.file(name)))) {
      fail(folder.file(name),
           "differs from the manifest's checksum, so it is damaged; run the session again");
    }
  }
}

struct PartSpan {
  std::string name, recording, sensor;
  int first_map = 0, maps = 0;
  std::size_t first_scan = 0, scans = 0;
};

std::vector<PartSpan> part_spans(const SessionFolder& folder, const Json& manifest,
                                 std::size_t maps, std::size_t scans) {
  if (!manifest.contains("sessions")) {
    return {{folder.name(), manifest.at("recording").at("path").get<std::string>(),
             manifest.at("sensor").get<std::string>(), 0, static_cast<int>(maps), 0, scans}};
  }
  std::vector<PartSpan> spans;
  std::size_t map = 0;
  std::size_t scan = 0;
  for (const Json& s : manifest.at("sessions")) {
    PartSpan span;
    s.at("name").get_to(span.name);
    s.at("recording").get_to(span.recording);
    s.at("sensor").get_to(span.sensor);
    s.at("first_map").get_to(span.first_map);
    s.at("local_maps").get_to(span.maps);
    s.at("first_scan").get_to(span.first_scan);
    s.at("scans").get_to(span.scans);
    if (span.first_map != static_cast<int>(map) || span.first_scan != scan)
      fail(folder.file("manifest.json"), "the sessions do not follow one another");
    map += static_cast<std::size_t>(std::max(span.maps, 0));
    scan += span.scans;
    spans.push_back(std::move(span));
  }
  if (map != maps || scan != scans)
    fail(folder.file("manifest.json"), "the sessions do not add up to the tables");
  return spans;
}

Trajectory slice(const Trajectory& all, const PartSpan& span) {
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(span.first_scan);
  return {first, first + static_cast<std::ptrdiff_t>(span.scans)};
}

// Maps partition the scans: nothing downstream checks indices again.
void check_partition(const fs::path& file, const SessionPart& part) {
  std::size_t next = 0;
  for (std::size_t m = 0; m < part.maps.size(); ++m) {
    const LocalMapRecord& map = part.maps[m];
    if (map.map != static_cast<int>(m) || map.first_scan != next || map.last_scan < next)
      fail(file, "map " + std::to_string(map.map) + " does not follow the one before");
    next = map.last_scan + 1;
  }
  if (part.maps.empty() || next != part.trajectory.size())
    fail(file, "the maps do not cover the scans of the trajectory");
}

SessionPart make_part(const SessionFolder& folder, const PartSpan& span, const Trajectory& odometry,
                      const Trajectory& trajectory, const std::vector<LocalMapRecord>& maps) {
  SessionPart part;
  part.name = span.name;
  part.recording = span.recording;
  part.sensor = span.sensor;
  part.first_map = span.first_map;
  part.odometry = slice(odometry, span);
  part.trajectory = slice(trajectory, span);
  for (int m = 0; m < span.maps; ++m) {
    LocalMapRecord map = maps[span.first_map + m];
    if (map.map != span.first_map + m || map.first_scan < span.first_scan)
      fail(folder.file("local_maps.csv"), "maps are not numbered in order");
    map.map = m;
    map.first_scan -= span.first_scan;
    map.last_scan -= span.first_scan;
    part.maps.push_back(map);
  }
  check_partition(folder.file("local_maps.csv"), part);
  return part;
}

std::uint64_t fingerprint(const std::vector<MapDescription>& descriptions) {
  std::uint64_t sum = fnv1a({});
  for (const MapDescription& d : descriptions) {
    sum = fnv1a(std::as_bytes(std::span(d.descriptors)), sum);
    sum = fnv1a(std::as_bytes(std::span(d.keypoints)), sum);
  }
  return sum;
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

// Leaves out the closures that the session itself gave up, and calls edges between recordings
// closures whatever their ids.
void read_graph(StoredSession& session) {
  const fs::path file = session.folder.file("pose_graph.g2o");
  session.graph = read_g2o(file).graph;
  std::vector<int> part_of;
  for (std::size_t p = 0; p < session.parts.size(); ++p)
    part_of.insert(part_of.end(), session.parts[p].maps.size(), static_cast<int>(p));
  if (session.graph.vertices.size() != part_of.size())
    fail(file, "vertices and local maps differ in number; run the session again");
  for (std::size_t v = 0; v < part_of.size(); ++v) {
    if (session.graph.vertices[v].id != static_cast<int>(v))
      fail(file, "vertices are not numbered as local maps; run the session again");
  }
  const auto given_up = [&](const GraphEdge& edge) {
    const int q = part_of[edge.from];
    const int r = part_of[edge.to];
    return std::any_of(
        session.closures.begin(), session.closures.end(), [&](const ClosureRecord& c) {
          return c.status == ClosureStatus::outlier && c.query_session == session.parts[q].name &&
                 c.reference_session == session.parts[r].name &&
                 c.query_map == edge.from - session.parts[q].first_map &&
                 c.reference_map == edge.to - session.parts[r].first_map &&
                 (c.T_query_reference.translation - edge.T_from_to.translation).norm() < 1e-9;
        });
  };
  for (GraphEdge& edge : session.graph.edges) {
    if (part_of[edge.from] != part_of[edge.to]) edge.kind = EdgeKind::closure;
  }
  std::erase_if(session.graph.edges, [&](const GraphEdge& edge) {
    return edge.kind == EdgeKind::closure && given_up(edge);
  });
}

}  // namespace

StoredSession load_session(const fs::path& path, const LoopClosureOptions& options) {
  StoredSession session{SessionFolder(path), {}, {}, {}};
  const SessionFolder& folder = session.folder;
  const Json manifest = read_manifest(folder);
  try {
    check_files(folder, manifest);
    const Trajectory odometry = read_tum(folder.file("odometry.tum"));
    const Trajectory trajectory = read_tum(folder.file("trajectory.tum"));
    const std::vector<LocalMapRecord> maps = read_local_maps(folder.file("local_maps.csv"));
    if (odometry.size() != trajectory.size())
      fail(folder.file("odometry.tum"), "odometry and trajectory differ in length");
    for (const PartSpan& span : part_spans(folder, manifest, maps.size(), trajectory.size()))
      session.parts.push_back(make_part(folder, span, odometry, trajectory, maps));
  } catch (const Json::exception&) {
    fail(folder.file("manifest.json"), "damaged or of another version; run the recording again");
  }
  session.closures = read_closures(folder.file("closures.csv"));
  if (session.parts.size() == 1) {
    // The folder may have been renamed since.
    for (ClosureRecord& c : session.closures)
      c.reference_session = c.query_session = session.parts.front().name;
  }
  const fs::path database = folder.file("loop_database.bin");
  add_descriptions(database, LoopDatabase::load(database, options), session.parts);
  read_graph(session);
  return session;
}

}  // namespace groundloop
