#include "frontend/recordings/no_recording.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <nlohmann/json.hpp>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

struct Unread {
  const char* extension;
  const char* what_to_do;  ///< with %s for the file's name
};
constexpr std::array kUnread = {
    Unread{".osf",
           "Ouster's .osf files are not read; convert it with Ouster's SDK: `ouster-cli source %s "
           "save OUT.pcap` or `save OUT.bag`"},
    Unread{".pcapng", "is a pcapng capture; convert it with `editcap -F pcap %s OUT.pcap`"},
    Unread{".lvx",
           "Livox Viewer's files are not read; convert it to a bag with "
           "livox_ros_driver's lvx_to_rosbag.launch"},
    Unread{".lvx2", "Livox Viewer's files are not read; record with livox_ros_driver2 to a bag"},
    Unread{".las", "is a map or a static scan; a recording has its scans one by one, with times"},
    Unread{".laz", "is a map or a static scan; a recording has its scans one by one, with times"},
    Unread{".e57", "is a map or a static scan; a recording has its scans one by one, with times"},
    Unread{".zip", "is an archive; unpack it first: `unzip %s`"},
    Unread{".tar", "is an archive; unpack it first: `tar -xf %s`"},
    Unread{".tgz", "is an archive; unpack it first: `tar -xf %s`"},
    Unread{".gz", "is packed; unpack it first: `tar -xf` or `gunzip`"},
    Unread{".xz", "is packed; unpack it first: `tar -xf` or `unxz`"},
    Unread{".7z", "is an archive; unpack it first: `7z x %s`"},
};

void refuse_file(const fs::path& path) {
  const std::string name = path.filename().string();
  for (const Unread& unread : kUnread) {
    if (!name.ends_with(unread.extension)) continue;
    std::string text = unread.what_to_do;
    const std::size_t place = text.find("%s");
    if (place != std::string::npos) text.replace(place, 2, name);
    throw InputError(path.string() + ": " + text);
  }
}

// What the manifest of a session says; nothing where the file is something else's.
nlohmann::json manifest_of(const fs::path& folder) {
  constexpr std::uintmax_t kLargest = 64U << 20U;
  std::error_code error;
  const fs::path file = folder / "manifest.json";
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kLargest) return {};
  const auto document = nlohmann::json::parse(read_text(file), nullptr, false);
  if (!document.is_object() || !document.contains("session_format")) return {};
  return document;
}

void refuse_session(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error).lexically_normal();
  const fs::path self = absolute.has_filename() ? absolute : absolute.parent_path();
  const bool part = self.filename() == "local_maps" || !fs::is_directory(self, error);
  const fs::path session = part ? self.parent_path() : self;
  const nlohmann::json manifest = manifest_of(session);
  if (manifest.is_null()) return;
  std::string recording;
  const nlohmann::json::json_pointer place("/recording/path");
  if (manifest.contains(place) && manifest.at(place).is_string())
    recording = manifest.at(place).get<std::string>();
  throw InputError(path.string() + ": " + (part ? "belongs to" : "is") +
                   " a session that groundloop made, and no recording; did you mean " +
                   (recording.empty() ? "" : "its recording, " + recording + ", or ") +
                   "`groundloop doctor " + session.string() + "`?");
}

// Folders below `folder` that hold recordings, to a depth; few are looked at.
void gather(const fs::path& folder, int depth,
            const std::function<bool(const fs::path&)>& is_recording, std::size_t& looked_at,
            std::vector<fs::path>& found) {
  constexpr std::size_t kMost = 300;
  std::vector<fs::path> below;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code no_folder;
    if (it->is_directory(no_folder) && !it->path().filename().string().starts_with("."))
      below.push_back(it->path());
    if (++looked_at > 20 * kMost) return;
  }
  std::sort(below.begin(), below.end());
  for (const fs::path& one : below) {
    if (++looked_at > kMost) return;
    if (is_recording(one)) {
      found.push_back(one);
    } else if (depth > 1) {
      gather(one, depth - 1, is_recording, looked_at, found);
    }
  }
}

}  // namespace

void refuse_what_is_no_recording(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) refuse_file(path);
  refuse_session(path);
}

std::string not_recognised(const fs::path& path, const std::string& looked_for,
                           const std::function<bool(const fs::path&)>& is_recording) {
  constexpr std::size_t kNamed = 6;
  std::vector<fs::path> found;
  std::size_t looked_at = 0;
  std::error_code error;
  if (fs::is_directory(path, error)) gather(path, 3, is_recording, looked_at, found);
  if (found.empty())
    return path.string() + ": no recording is recognised here; looked for " + looked_for;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, found.size()); ++i)
    names += (i == 0 ? "" : ", ") + found[i].string();
  if (found.size() > kNamed) names += " and " + std::to_string(found.size() - kNamed) + " more";
  return path.string() + ": holds no recording itself, but " +
         (found.size() == 1 ? "this folder below does: " : "these folders below do: ") + names +
         "; name one of them";
}

}  // namespace groundloop::recordings
