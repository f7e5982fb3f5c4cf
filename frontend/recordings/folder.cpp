#include "frontend/recordings/folder.hpp"

#include <algorithm>
#include <array>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/bin_layout.hpp"
#include "frontend/recordings/point_files.hpp"
#include "frontend/recordings/scan_files.hpp"
#include "frontend/recordings/truth_conventions.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr const char* kBinFields = "float32 x y z intensity ...";
constexpr std::array<const char*, 3> kExtensions = {".bin", ".pcd", ".ply"};

bool holds_scans(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder, error) &&
         std::any_of(kExtensions.begin(), kExtensions.end(),
                     [&](const char* extension) { return !list_files(folder, extension).empty(); });
}

// Where data sets keep a sequence's scans below its folder: Boreas, Newer College, Oxford Spires.
fs::path scans_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error) || holds_scans(path)) return path;
  if (fs::is_directory(path / "applanix", error) && holds_scans(path / "lidar"))
    return path / "lidar";
  for (const fs::path& below : {fs::path("raw_format") / "ouster_scan",
                                fs::path("raw") / "lidar-clouds", fs::path("lidar-clouds")}) {
    if (holds_scans(path / below)) return path / below;
  }
  return path;
}

bool is_scan_file(const fs::path& file, const char* extension) {
  std::error_code error;
  return file.extension() == extension && fs::is_regular_file(file, error);
}

class FolderRecording final : public ScanFiles {
 public:
  /// `path`: the folder, or one scan.
  FolderRecording(const fs::path& path, const RecordingOptions& options)
      : ScanFiles(path, "folder", options), time_unit_(options.time_unit) {
    std::error_code error;
    const fs::path folder = scans_of(path);
    if (fs::is_directory(folder, error)) {
      choose_files(folder);
      find_stamps(folder);
    } else {
      choose_file(path);
    }
    if (extension_ == ".bin") {
      choose_bin_layout(options.fields);
    } else {
      check_last([&](std::size_t i) {
        read_file_into(files_[i], buffer_);
        (void)parse(i);
      });
    }
    info_.gaps = count_gaps(stamps_);
    learn_layout();
    if (fs::is_directory(folder, error)) find_truth(folder);
  }

 private:
  void choose_files(const fs::path& folder) {
    for (const char* extension : kExtensions) {
      std::vector<fs::path> files = list_files(folder, extension);
      if (files.empty()) continue;
      if (!files_.empty()) {
        const bool more = files.size() > files_.size();
        info_.notes.push_back(std::to_string(more ? files_.size() : files.size()) + " " +
                              (more ? extension_ : extension) +
                              " files beside the scans are ignored.");
        if (!more) continue;
      }
      files_ = std::move(files);
      extension_ = extension;
    }
    if (files_.empty()) {
      throw InputError(folder.string() + ": holds no scan; expected *.bin, *.pcd or *.ply files");
    }
  }

  void choose_file(const fs::path& file) {
    files_ = {file};
    for (const char* extension : kExtensions) {
      if (is_scan_file(file, extension)) extension_ = extension;
    }
    info_.notes.emplace_back("This is one scan; a recording is the folder of its scans.");
    if (!take_named_stamps()) assume_stamps("The file's name is no stamp");
  }

  bool take_named_stamps() {
    auto named = stamps_from_names(files_);
    if (!named) return false;
    stamps_ = std::move(named->stamps);
    info_.stamp_source = "file names (" + named->unit + ")";
    return true;
  }

  void assume_stamps(const std::string& why) {
    stamps_known_ = false;
    stamps_ = assumed_stamps(files_.size());
    info_.stamp_source = "assumed 10 Hz";
    info_.notes.push_back(why + "; 10 scans a second are assumed.");
  }

  void find_stamps(const fs::path& folder) {
    std::error_code error;
    const fs::path absolute = fs::absolute(folder).lexically_normal();
    for (const fs::path& place : {absolute, (absolute / "..").lexically_normal()}) {
      for (const char* name : {"times.txt", "timestamps.txt"}) {
        if (!fs::is_regular_file(place / name, error)) continue;
        stamps_ = match_stamps(files_, place / name, read_stamp_file(place / name)).stamps;
        info_.stamp_source = name;
        return;
      }
    }
    if (!take_named_stamps()) assume_stamps("Neither times.txt nor file names give stamps");
  }

  std::size_t decode(std::size_t index, Scan& scan) override {
    return decode_table(index, parse(index), {times_ ? &*times_ : nullptr, {}, nullptr}, scan);
  }

  void choose_bin_layout(const std::string& asked) {
    const BinLayout chosen = recordings::choose_bin_layout(files_, asked);
    bin_layout_ = chosen.layout();
    check_lengths(bin_layout_.packed_size, kBinFields);
    if (!chosen.evidence.empty()) info_.notes.push_back(chosen.evidence);
  }

  // Of buffer_, the bytes of files_[index].
  PointTable parse(std::size_t index) {
    const std::string name = files_[index].string();
    if (extension_ == ".pcd") return parse_pcd(buffer_, name);
    if (extension_ == ".ply") return parse_ply(buffer_, name);
    return {bin_layout_, record_count(index, bin_layout_.packed_size, kBinFields)};
  }

  // Fields and the meaning of their times, from scans spread over the recording: those that can be
  // used.
  void learn_layout() {
    TimeSurvey survey;
    std::string fault;
    for (const std::size_t index : spread_indices(files_.size())) {
      read_file_into(files_[index], buffer_);
      PointTable table;
      try {
        table = parse(index);
      } catch (const InputError& e) {
        if (fault.empty()) fault = e.what();
        continue;
      }
      if (info_.fields.empty()) {
        info_.fields = table.layout.described();
        info_.attributes = table.layout.attributes();
      }
      survey.add(table.layout, buffer_, table.count, stamps_[index], files_[index].string());
    }
    if (info_.fields.empty() && !fault.empty()) throw InputError(fault);
    times_ = survey.finish({scan_duration(stamps_), stamps_known_, time_unit_}, info_);
  }

  void find_truth(const fs::path& folder) {
    const auto found = recordings::find_truth(folder);
    if (found) ground_truth_ = read_truth(*found, all_stamps(), info_);
  }

  std::string extension_;
  PointLayout bin_layout_;
  std::string time_unit_;
  bool stamps_known_ = true;
  std::optional<TimeModel> times_;
};

}  // namespace

bool is_scan_folder(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return holds_scans(scans_of(path));
  return std::any_of(kExtensions.begin(), kExtensions.end(),
                     [&](const char* extension) { return is_scan_file(path, extension); });
}

std::unique_ptr<Recording> open_folder(const fs::path& folder, const RecordingOptions& options) {
  return std::make_unique<FolderRecording>(folder, options);
}

}  // namespace groundloop::recordings
