#include "backend/session/manifest.hpp"

#include <algorithm>
#include <array>

#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFile = "manifest.json";
// Far above what a session can hold, far below what overflows.
constexpr std::size_t kMaxCount = 1'000'000'000;

constexpr std::array kStages{SessionStage::started, SessionStage::odometry, SessionStage::complete};

[[noreturn]] void fail(const SessionFolder& folder, const std::string& what) {
  throw InputError(folder.file(kFile).string() + ": " + what);
}

std::string text(const Json& object, const char* key) { return object.at(key).get<std::string>(); }

std::size_t count(const Json& object, const char* key, const SessionFolder& folder) {
  const Json& value = object.at(key);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kMaxCount)
    fail(folder, std::string(key) + ": '" + value.dump() + "' is no count");
  return value.get<std::size_t>();
}

// Of what sessions of earlier versions do not have.
std::size_t count_if_any(const Json& object, const char* key, const SessionFolder& folder) {
  return object.contains(key) ? count(object, key, folder) : 0;
}

Json identity_document(const SessionIdentity& identity) {
  return {{"command", identity.command},
          {"version", identity.version},
          {"input", identity.input},
          {"configuration", identity.configuration}};
}

SessionIdentity identity_from(const Json& object) {
  return {text(object, "command"), text(object, "version"), text(object, "input"),
          text(object, "configuration")};
}

SessionStage stage_from(const std::string& name, const SessionFolder& folder) {
  for (const SessionStage stage : kStages) {
    if (name == to_string(stage)) return stage;
  }
  fail(folder, "stage '" + name + "' is unknown");
}

Json part_document(const ManifestPart& part) {
  return {{"name", part.name},
          {"input", part.input},
          {"recording", part.recording},
          {"sensor", part.sensor},
          {"scans", part.scans},
          {"first_scan", part.first_scan},
          {"local_maps", part.local_maps},
          {"first_map", part.first_map},
          {"scan_files", part.scan_files},
          {"first_scan_file", part.first_scan_file},
          {"frame", part.frame},
          {"connected", part.connected},
          {"fixed", part.fixed}};
}

ManifestPart part_from(const Json& object, const SessionFolder& folder) {
  ManifestPart part;
  part.name = text(object, "name");
  part.input = text(object, "input");
  part.recording = text(object, "recording");
  part.sensor = text(object, "sensor");
  part.scans = count(object, "scans", folder);
  part.first_scan = count(object, "first_scan", folder);
  part.local_maps = count(object, "local_maps", folder);
  part.first_map = count(object, "first_map", folder);
  part.scan_files = count_if_any(object, "scan_files", folder);
  part.first_scan_file = count_if_any(object, "first_scan_file", folder);
  part.frame = text(object, "frame");
  part.connected = object.at("connected").get<bool>();
  part.fixed = object.at("fixed").get<bool>();
  return part;
}

// Parts have names of their own, follow one another, and lie in frames of parts.
void check_parts(const Manifest& manifest, const SessionFolder& folder) {
  std::size_t map = 0;
  std::size_t scan = 0;
  std::size_t scan_file = 0;
  const auto named = [&](const std::string& name) {
    return std::count_if(manifest.parts.begin(), manifest.parts.end(),
                         [&](const ManifestPart& p) { return p.name == name; });
  };
  for (const ManifestPart& part : manifest.parts) {
    check_part_name(part.name, folder.file(kFile).string() + ": session");
    if (named(part.name) != 1) fail(folder, "two sessions are called '" + part.name + "'");
    if (named(part.frame) != 1) fail(folder, "frame '" + part.frame + "' is no session's name");
    if (part.first_map != map || part.first_scan != scan || part.first_scan_file != scan_file)
      fail(folder, "session '" + part.name + "' does not follow the one before");
    map += part.local_maps;
    scan += part.scans;
    scan_file += part.scan_files;
  }
  if (manifest.merged() &&
      (map != manifest.local_maps || scan != manifest.scans || scan_file != manifest.scan_files))
    fail(folder, "the sessions do not add up to the whole");
}

Manifest manifest_from(const Json& document, const SessionFolder& folder) {
  Manifest manifest;
  manifest.stage = stage_from(text(document, "stage"), folder);
  manifest.identity = identity_from(document.at("made_by"));
  manifest.scans = count(document, "scans", folder);
  manifest.local_maps = count(document, "local_maps", folder);
  manifest.scan_files = count_if_any(document, "scan_files", folder);
  if (document.contains("recording")) {
    manifest.recording = document.at("recording");
    (void)text(manifest.recording, "path");  // that all readers ask for
    manifest.sensor = text(document, "sensor");
  }
  if (document.contains("sessions")) {
    for (const Json& part : document.at("sessions"))
      manifest.parts.push_back(part_from(part, folder));
    for (const Json& left : document.at("left_out"))
      manifest.left_out.push_back({text(left, "input"), text(left, "reason")});
    document.at("connections").get_to(manifest.connections);
  }
  if (manifest.recording.is_null() && manifest.parts.empty() &&
      manifest.stage == SessionStage::complete)
    fail(folder, "names neither a recording nor sessions");
  for (const auto& [name, sum] : document.at("checksums").items())
    manifest.checksums.emplace(name, sum.get<std::string>());
  check_parts(manifest, folder);
  return manifest;
}

Json manifest_document(const Manifest& manifest) {
  Json document{{"groundloop", manifest.identity.version},
                {"session_format", kSessionFormat},
                {"stage", to_string(manifest.stage)},
                {"made_by", identity_document(manifest.identity)},
                {"scans", manifest.scans},
                {"local_maps", manifest.local_maps},
                {"scan_files", manifest.scan_files},
                {"seed", 0}};
  if (!manifest.recording.is_null()) {
    document["recording"] = manifest.recording;
    document["sensor"] = manifest.sensor;
    document["stamps"] =
        "the instant of a pose is that of its scan's stamp, the start of the scan unless the "
        "format says otherwise";
  }
  if (manifest.merged()) {
    document["frames"] =
        "poses of recordings of one frame are in the world of the recording that names it; ids of "
        "maps and vertices are offset by first_map, rows of trajectories by first_scan; the map "
        "holds the first frame";
    document["sessions"] = Json::array();
    for (const ManifestPart& part : manifest.parts)
      document["sessions"].push_back(part_document(part));
    document["left_out"] = Json::array();
    for (const ManifestLeftOut& left : manifest.left_out)
      document["left_out"].push_back({{"input", left.input}, {"reason", left.reason}});
    document["connections"] = manifest.connections;
  }
  document["checksum"] = kChecksumName;
  document["checksums"] = Json::object();
  for (const auto& [name, sum] : manifest.checksums) document["checksums"][name] = sum;
  return document;
}

}  // namespace

const char* to_string(SessionStage stage) {
  switch (stage) {
    case SessionStage::started:
      return "started";
    case SessionStage::odometry:
      return "odometry";
    case SessionStage::complete:
      return "complete";
  }
  return "";
}

void check_part_name(const std::string& name, const std::string& place) {
  const bool plain = !name.empty() && name != "." && name != ".." && name.size() <= 200 &&
                     std::none_of(name.begin(), name.end(), [](unsigned char c) {
                       return c < 0x20 || c == 0x7f || c == '/' || c == '\\';
                     });
  if (!plain) {
    throw InputError(place + " '" + name +
                     "' is no plain name of a folder; rename the session's folder");
  }
}

bool has_manifest(const SessionFolder& folder) {
  std::error_code error;
  return fs::is_regular_file(folder.file(kFile), error);
}

bool is_session(const SessionFolder& folder) {
  if (!has_manifest(folder)) return false;
  try {
    const Json document = Json::parse(read_text(folder.file(kFile)), nullptr, false);
    return document.is_object() && document.contains("groundloop") &&
           document.contains("session_format");
  } catch (const InputError&) {
    return false;
  }
}

Manifest read_manifest(const SessionFolder& folder) {
  std::error_code error;
  if (!fs::is_directory(folder.path(), error))
    throw InputError(folder.path().string() + ": there is no such session");
  if (!has_manifest(folder)) {
    throw InputError(folder.path().string() +
                     ": is no session, manifest.json is missing; give a folder that `groundloop "
                     "run` or `merge` made");
  }
  const Json document = Json::parse(read_text(folder.file(kFile)), nullptr, false);
  if (!document.is_object()) fail(folder, "damaged, it is no JSON object; make the session again");
  try {
    if (const Json format = document.value("session_format", Json(0)); format != kSessionFormat) {
      fail(folder, "a session of format " + format.dump() + ", made by groundloop " +
                       document.value("groundloop", std::string("of unknown version")) +
                       "; this version reads format " + std::to_string(kSessionFormat) +
                       ", so make it again with `groundloop " +
                       (document.contains("sessions") ? "merge" : "run") + "`");
    }
    return manifest_from(document, folder);
  } catch (const Json::exception& e) {
    fail(folder, std::string("damaged (") + e.what() + "); make the session again");
  }
}

Manifest read_complete_manifest(const SessionFolder& folder) {
  Manifest manifest = read_manifest(folder);
  if (manifest.stage != SessionStage::complete) {
    fail(folder, std::string("the session is unfinished (stage ") + to_string(manifest.stage) +
                     "); finish it with `groundloop " + manifest.identity.command + " --resume`");
  }
  return manifest;
}

void write_manifest(const SessionFolder& folder, const Manifest& manifest) {
  write_text_atomically(folder.file(kFile), manifest_document(manifest).dump(2) + "\n");
}

std::map<std::string, std::string> checksums_of(const SessionFolder& folder, std::size_t local_maps,
                                                std::size_t scan_files) {
  std::map<std::string, std::string> checksums;
  for (const std::string& name : SessionFolder::lasting_files()) {
    if (fs::exists(folder.file(name))) checksums[name] = hex(checksum_of_file(folder.file(name)));
  }
  for (std::size_t m = 0; m < local_maps; ++m) {
    const fs::path file = folder.local_map(static_cast<int>(m));
    checksums["local_maps/" + file.filename().string()] = hex(checksum_of_file(file));
  }
  for (std::size_t n = 0; n < scan_files; ++n) {
    const fs::path file = folder.scan_file(n);
    checksums["scans/" + file.filename().string()] = hex(checksum_of_file(file));
  }
  return checksums;
}

}  // namespace groundloop
