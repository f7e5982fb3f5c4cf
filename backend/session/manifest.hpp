// manifest.json: what a session is, what it was made from, how far it has come, and the checksums
// of its files. Written when a session is begun, with every stage that is finished, and last of all
// when it is complete: a session is what its manifest says.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "backend/session/session.hpp"

namespace groundloop {

/// How far a session has come.
enum class SessionStage {
  started,   ///< scans are being registered, or sessions matched
  odometry,  ///< every scan is registered and every local map searched for closures
  complete,
};
[[nodiscard]] const char* to_string(SessionStage stage);

/// What a session belongs to: the same identity gives the same bytes.
struct SessionIdentity {
  std::string command;        ///< "run" or "merge"
  std::string version;        ///< of groundloop
  std::string input;          ///< checksum of what the recording or the sessions hold
  std::string configuration;  ///< checksum of config.yaml
  friend bool operator==(const SessionIdentity&, const SessionIdentity&) = default;
};

/// One recording of a merged session. Counts and offsets are those of the merged tables.
struct ManifestPart {
  std::string name;       ///< a plain name, no path
  std::string input;      ///< folder of the session it came from
  std::string recording;  ///< path it was read from
  std::string sensor;
  std::size_t scans = 0, first_scan = 0;
  std::size_t local_maps = 0, first_map = 0;
  std::string frame;  ///< name of the part in whose world its poses are
  bool connected = false, fixed = false;
  std::size_t scan_files = 0, first_scan_file = 0;  ///< none where no scans were kept
};

struct ManifestLeftOut {
  std::string input, reason;
};

struct Manifest {
  SessionStage stage = SessionStage::started;
  SessionIdentity identity;
  std::size_t scans = 0, local_maps = 0;
  std::size_t scan_files = 0;  ///< 0 where no scans were kept
  /// Of a session of one recording; null in a merged one.
  nlohmann::ordered_json recording;
  std::string sensor;
  /// Of a merged session; empty in one of one recording.
  std::vector<ManifestPart> parts;
  std::vector<ManifestLeftOut> left_out;
  std::vector<std::string> connections;
  /// Of every file that holds neither times nor logs, by its name in the session.
  std::map<std::string, std::string> checksums;

  [[nodiscard]] bool merged() const { return !parts.empty(); }
};

/// The session format this version reads and writes.
inline constexpr int kSessionFormat = 3;

/// A file of the folder by the name `manifest.json`, whether it can be read or not.
[[nodiscard]] bool has_manifest(const SessionFolder& folder);
/// True where that file says that groundloop made it, in whatever format.
[[nodiscard]] bool is_session(const SessionFolder& folder);
/// Throws InputError naming the file and the remedy where it is missing, damaged, of another
/// format, or where it says what cannot be (names that are paths, parts that do not follow one
/// another).
[[nodiscard]] Manifest read_manifest(const SessionFolder& folder);
/// The same, of a session that is complete.
[[nodiscard]] Manifest read_complete_manifest(const SessionFolder& folder);
void write_manifest(const SessionFolder& folder, const Manifest& manifest);

/// Checksums of the session's files as they lie in the folder.
[[nodiscard]] std::map<std::string, std::string> checksums_of(const SessionFolder& folder,
                                                              std::size_t local_maps,
                                                              std::size_t scan_files);

/// Throws InputError beginning with `place` unless `name` can be the name of a recording in a
/// session: it becomes the name of a folder.
void check_part_name(const std::string& name, const std::string& place);

}  // namespace groundloop
