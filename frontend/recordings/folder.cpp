#include "frontend/recordings/folder.hpp"

#include <algorithm>
#include <array>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/bin_layout.hpp"
#include "frontend/recordings/ground_truth.hpp"
#include "frontend/recordings/point_files.hpp"
#include "frontend/recordings/scan_files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr const char* kBinFields = "float32 x y z intensity ...";
constexpr std::array<const char*, 3> kExtensions = {".bin", ".pcd", ".ply"};

class FolderRecording final : public ScanFiles {
 public:
  FolderRecording(const fs::path& folder, const RecordingOptions& options)
      : ScanFiles(folder, "folder", options), time_unit_(options.time_unit) {
    choose_files(folder);
    find_stamps(folder);
    info_.gaps = count_gaps(stamps_);
    if (extension_ == ".bin") choose_bin_layout(options.fields);
    learn_layout();
    find_truth(folder);
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
    if (auto named = stamps_from_names(files_)) {
      stamps_ = std::move(named->stamps);
      info_.stamp_source = "file names (" + named->unit + ")";
      return;
    }
    stamps_known_ = false;
    stamps_ = assumed_stamps(files_.size());
    info_.stamp_source = "assumed 10 Hz";
    info_.notes.emplace_back(
        "Neither times.txt nor file names give stamps; 10 scans a second are assumed.");
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

  // Fields and the meaning of their times, from scans spread over the recording.
  void learn_layout() {
    TimeSurvey survey;
    for (const std::size_t index : spread_indices(files_.size())) {
      read_file_into(files_[index], buffer_);
      const PointTable table = parse(index);
      if (info_.fields.empty()) {
        info_.fields = table.layout.described();
        info_.attributes = table.layout.attributes();
      }
      survey.add(table.layout, buffer_, table.count, stamps_[index], files_[index].string());
    }
    times_ = survey.finish({scan_duration(stamps_), stamps_known_, time_unit_}, info_);
  }

  void find_truth(const fs::path& folder) {
    const fs::path absolute = fs::absolute(folder).lexically_normal();
    const fs::path parent =
        (absolute.has_filename() ? absolute : absolute.parent_path()).parent_path();
    const fs::path file = find_ground_truth({absolute, parent});
    if (file.empty()) return;
    ground_truth_ = read_ground_truth(file, stamps_);
    info_.notes.push_back("Ground truth is " + file.filename().string() +
                          ", taken to be of the LiDAR itself.");
  }

  std::string extension_;
  PointLayout bin_layout_;
  std::string time_unit_;
  bool stamps_known_ = true;
  std::optional<TimeModel> times_;
};

}  // namespace

bool is_scan_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return false;
  return std::any_of(kExtensions.begin(), kExtensions.end(),
                     [&](const char* extension) { return !list_files(folder, extension).empty(); });
}

std::unique_ptr<Recording> open_folder(const fs::path& folder, const RecordingOptions& options) {
  return std::make_unique<FolderRecording>(folder, options);
}

}  // namespace groundloop::recordings
