#include "apps/report/session_contents.hpp"

#include <algorithm>

#include "apps/report/report_cost.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

nlohmann::ordered_json read_json(const fs::path& file) {
  try {
    return nlohmann::ordered_json::parse(read_text(file));
  } catch (const nlohmann::json::exception&) {
    throw InputError(file.string() + ": no valid JSON; run the recording again");
  }
}

template <typename Rows, typename Read>
void read_optional(const fs::path& file, Rows& rows, std::vector<std::string>& unreadable,
                   Read&& read) {
  try {
    rows = read(file);
  } catch (const InputError& e) {
    unreadable.emplace_back(e.what());
  }
}

int frame_named(const std::string& name, std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  names.push_back(name);
  return static_cast<int>(names.size()) - 1;
}

// The pieces of a recording, where its table covers its scans; else the whole.
void add_strands(const SessionContents& contents, std::size_t part, const std::string& frame,
                 std::vector<Strand>& strands, std::vector<std::string>& names) {
  const SessionPart& recording = contents.session.parts[part];
  const std::size_t scans = recording.trajectory.size();
  std::vector<Strand> pieces;
  std::size_t next = 0;
  if (!contents.merged()) {
    for (const OdometryPiece& p : contents.pieces) {
      if (p.first_scan != next || p.last_scan < next || p.last_scan >= scans) break;
      const std::string piece = "piece " + std::to_string(p.piece);
      pieces.push_back({piece, part, frame_named("piece " + std::to_string(p.frame), names), next,
                        p.last_scan + 1 - next});
      next = p.last_scan + 1;
    }
  }
  if (pieces.size() > 1 && next == scans) {
    strands.insert(strands.end(), pieces.begin(), pieces.end());
    return;
  }
  if (!contents.merged()) names.clear();
  strands.push_back({recording.name, part, frame_named(frame, names), 0, scans});
}

void find_strands(SessionContents& contents) {
  for (std::size_t p = 0; p < contents.session.parts.size(); ++p) {
    std::string frame = contents.session.parts.front().name;
    if (contents.merged()) frame = contents.manifest.parts[p].frame;
    add_strands(contents, p, frame, contents.strands, contents.frame_names);
  }
}

}  // namespace

std::size_t SessionContents::part_index(const std::string& name) const {
  for (std::size_t p = 0; p < session.parts.size(); ++p) {
    if (session.parts[p].name == name) return p;
  }
  throw InputError(session.folder.file("closures.csv").string() + ": no recording is called '" +
                   name + "'; merge the sessions again");
}

std::size_t SessionContents::first_scan_of(std::size_t part) const {
  std::size_t first = 0;
  for (std::size_t p = 0; p < part; ++p) first += session.parts[p].trajectory.size();
  return first;
}

namespace {

SessionContents with_tables(SessionContents contents) {
  const SessionFolder& folder = contents.session.folder;
  std::vector<std::string>& unreadable = contents.unreadable;
  if (fs::exists(folder.file("metrics.json")))
    contents.metrics = page_metrics(read_json(folder.file("metrics.json")));
  read_optional(folder.file("odometry_quality.csv"), contents.quality, unreadable,
                read_odometry_quality);
  read_optional(folder.file("pieces.csv"), contents.pieces, unreadable, read_pieces);
  read_optional(folder.file("scan_closures.csv"), contents.scan_closures, unreadable,
                read_scan_closures);
  read_optional(folder.file("uncertainty.csv"), contents.uncertainty, unreadable, read_uncertainty);
  find_strands(contents);
  return contents;
}

SessionContents with_session(StoredSession session, Manifest manifest, Config config) {
  SessionContents contents{
      std::move(session), std::move(config), std::move(manifest), {}, {}, {}, {}, {}, {}, {}, {}};
  return contents;
}

}  // namespace

SessionContents read_session_contents(const fs::path& path) {
  const SessionFolder folder(path);
  Config config;
  std::vector<std::string> unreadable;
  if (const fs::path file = folder.file("config.yaml"); fs::exists(file)) {
    read_optional(file, config, unreadable, [](const fs::path& f) {
      Config read;
      read_config(read, f.string());
      return read;
    });
  }
  Manifest manifest = read_complete_manifest(folder);
  StoredSession session = load_session(path, config.slam.loop_closure);
  SessionContents contents =
      with_session(std::move(session), std::move(manifest), std::move(config));
  contents.unreadable = std::move(unreadable);
  return with_tables(std::move(contents));
}

SessionContents read_session_contents(const SessionFolder& folder, const std::string& name,
                                      const Manifest& manifest, const Config& config) {
  return with_tables(with_session(read_session(folder, name, manifest, config.slam.loop_closure),
                                  manifest, config));
}

}  // namespace groundloop::apps
