#include "frontend/recordings/bags.hpp"

#include <algorithm>
#include <limits>

#include <yaml-cpp/yaml.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/bag_recording.hpp"
#include "frontend/recordings/compression.hpp"
#include "frontend/recordings/unpacked_file.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

bool has_extension(const fs::path& file, const char* extension) {
  std::error_code error;
  return file.filename().string().ends_with(extension) && fs::is_regular_file(file, error);
}

// The file, or the files of a folder, with an extension.
std::vector<fs::path> files_of(const fs::path& path, const char* extension) {
  std::error_code error;
  if (has_extension(path, extension)) return {path};
  if (!fs::is_directory(path, error)) return {};
  const std::string end = extension, last = end.substr(end.rfind('.'));
  std::vector<fs::path> files = list_files(path, last);
  if (last != end)
    std::erase_if(files, [&](const fs::path& file) { return !has_extension(file, extension); });
  return files;
}

// A recorder that was interrupted leaves its bag under this name.
constexpr const char* kBag = ".bag";
constexpr const char* kActiveBag = ".bag.active";

std::vector<fs::path> all_paths(const fs::path& path, const RecordingOptions& options) {
  std::vector<fs::path> paths = {path};
  paths.insert(paths.end(), options.more_paths.begin(), options.more_paths.end());
  return paths;
}

std::unique_ptr<Recording> open_files(const fs::path& path, const RecordingOptions& options,
                                      const char* format, const char* extension,
                                      FileOpener open_file) {
  std::vector<NamedFile> files;
  for (const fs::path& one : all_paths(path, options)) {
    std::vector<fs::path> found = files_of(one, extension);
    if (extension == kBag) {
      const std::vector<fs::path> active = files_of(one, kActiveBag);
      found.insert(found.end(), active.begin(), active.end());
    }
    if (found.empty()) throw InputError(one.string() + ": holds no *" + extension + " file");
    for (const fs::path& file : found) files.push_back({file.string(), open_file(file)});
  }
  return make_bag_recording(path.string(), format, std::move(files), options, {});
}

// What metadata.yaml of a ROS 2 bag says; without it, what the files' names say.
struct Metadata {
  std::vector<fs::path> files;
  bool message_compression = false;
};

// A file of the bag by what metadata.yaml calls it. Bags before version 4 put the folder's own name
// before it. A bag that somebody else made does not choose which files of this machine are read.
fs::path named_file(const fs::path& metadata, const std::string& name) {
  const fs::path folder = metadata.parent_path();
  fs::path relative = fs::path(name).lexically_normal();
  std::error_code error;
  const fs::path own = fs::absolute(folder, error).lexically_normal();
  const fs::path own_name = own.has_filename() ? own.filename() : own.parent_path().filename();
  if (relative.has_parent_path() && *relative.begin() == own_name &&
      !fs::exists(folder / relative, error))
    relative = relative.lexically_relative(own_name);
  const bool inside = relative.is_relative() && !relative.empty() && *relative.begin() != "..";
  if (!inside) {
    throw InputError(metadata.string() + ": names '" + name +
                     "', which lies outside the bag's folder; put the file into the folder and "
                     "its plain name into relative_file_paths");
  }
  return folder / relative;
}

Metadata read_metadata(const fs::path& file) {
  Metadata metadata;
  try {
    const YAML::Node root = YAML::LoadFile(file.string());
    const YAML::Node bag = root["rosbag2_bagfile_information"];
    if (!bag || !bag["relative_file_paths"]) {
      throw InputError(file.string() + ": has no relative_file_paths; is this a ROS 2 bag?");
    }
    for (const YAML::Node& name : bag["relative_file_paths"]) {
      metadata.files.push_back(named_file(file, name.as<std::string>()));
    }
    const std::string mode =
        bag["compression_mode"] ? bag["compression_mode"].as<std::string>() : "";
    const std::string format =
        bag["compression_format"] ? bag["compression_format"].as<std::string>() : "";
    metadata.message_compression = mode == "MESSAGE" || mode == "message";
    if (!format.empty() && format != "zstd") {
      throw InputError(file.string() + ": compression '" + format + "' is unknown; zstd is read");
    }
  } catch (const YAML::Exception& e) {
    throw InputError(file.string() + ": is no YAML that can be read (" + e.what() + ")");
  }
  return metadata;
}

std::vector<fs::path> storage_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& file : list_files(folder, "")) {
    const std::string name = file.filename().string();
    for (const char* end : {".db3", ".mcap", ".db3.zstd", ".mcap.zstd"}) {
      if (name.ends_with(end)) files.push_back(file);
    }
  }
  return files;
}

// A file whose messages are zstd frames, each on its own.
class CompressedMessages final : public MessageFile {
 public:
  CompressedMessages(std::string name, std::unique_ptr<MessageFile> inner)
      : name_(std::move(name)), inner_(std::move(inner)) {
    topics_ = inner_->topics();
    notes_ = inner_->notes();
    warnings_ = inner_->warnings();
  }
  std::vector<MessageEntry> messages(const std::string& topic) override {
    return inner_->messages(topic);
  }
  void read(const MessageEntry& entry, std::size_t, std::vector<std::byte>& out) override {
    inner_->read(entry, std::numeric_limits<std::size_t>::max(), stored_);
    if (!decompress_zstd(stored_, out)) {
      throw InputError(name_ + ": a message is no zstd frame, as metadata.yaml says it is");
    }
  }

 private:
  std::string name_;
  std::unique_ptr<MessageFile> inner_;
  std::vector<std::byte> stored_;
};

std::unique_ptr<MessageFile> open_storage(const fs::path& file, bool compressed_messages) {
  std::unique_ptr<MessageFile> opened;
  if (file.extension() == ".zstd") {
    const FileOpener open = file.stem().extension() == ".mcap" ? open_mcap_file : open_sqlite_file;
    opened = open_unpacked(file, open);
  } else {
    opened = file.extension() == ".mcap" ? open_mcap_file(file) : open_sqlite_file(file);
  }
  if (!compressed_messages) return opened;
  return std::make_unique<CompressedMessages>(file.string(), std::move(opened));
}

}  // namespace

bool is_rosbag(const fs::path& path) {
  return !files_of(path, kBag).empty() || !files_of(path, kActiveBag).empty();
}

bool is_rosbag2(const fs::path& path) {
  std::error_code error;
  if (has_extension(path, ".db3")) return true;
  if (!fs::is_directory(path, error)) return false;
  if (fs::is_regular_file(path / "metadata.yaml", error)) return true;
  const std::vector<fs::path> files = storage_files(path);
  return std::any_of(files.begin(), files.end(),
                     [](const fs::path& file) { return file.extension() != ".mcap"; });
}

bool is_mcap(const fs::path& path) { return !files_of(path, ".mcap").empty(); }

std::unique_ptr<Recording> open_rosbag(const fs::path& path, const RecordingOptions& options) {
  return open_files(path, options, "rosbag", kBag, open_rosbag_file);
}

std::unique_ptr<Recording> open_mcap(const fs::path& path, const RecordingOptions& options) {
  return open_files(path, options, "mcap", ".mcap", open_mcap_file);
}

std::unique_ptr<Recording> open_rosbag2(const fs::path& path, const RecordingOptions& options) {
  std::error_code error;
  std::vector<NamedFile> files;
  std::vector<std::string> notes;
  for (const fs::path& one : all_paths(path, options)) {
    Metadata metadata;
    if (fs::is_regular_file(one / "metadata.yaml", error)) {
      metadata = read_metadata(one / "metadata.yaml");
    } else {
      metadata.files = fs::is_directory(one, error) ? storage_files(one) : std::vector{one};
      notes.push_back(one.filename().string() +
                      " has no metadata.yaml; its files are taken as they are.");
    }
    for (const fs::path& file : metadata.files) {
      if (!fs::is_regular_file(file, error)) {
        throw InputError(file.string() + ": is named in metadata.yaml but is not there");
      }
      files.push_back({file.string(), open_storage(file, metadata.message_compression)});
    }
  }
  if (files.empty()) throw InputError(path.string() + ": holds no .db3 or .mcap file");
  return make_bag_recording(path.string(), "rosbag2", std::move(files), options, std::move(notes));
}

}  // namespace groundloop::recordings
