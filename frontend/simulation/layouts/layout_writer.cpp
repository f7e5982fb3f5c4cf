#include "frontend/simulation/layouts/layout_writer.hpp"

#include <algorithm>

#include <unistd.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

// Ground truth at the scans' stamps; empty where it does not cover them all.
Trajectory ground_truth_at(const Recording& recording, const std::vector<Nanoseconds>& stamps) {
  const Trajectory truth = recording.ground_truth();
  Trajectory result;
  for (const Nanoseconds stamp : stamps) {
    const auto after =
        std::lower_bound(truth.begin(), truth.end(), stamp,
                         [](const StampedPose& pose, Nanoseconds s) { return pose.stamp < s; });
    if (after == truth.end()) return {};
    if (after->stamp == stamp) {
      result.push_back(*after);
      continue;
    }
    if (after == truth.begin()) return {};
    const StampedPose& before = *(after - 1);
    const double s = static_cast<double>(stamp - before.stamp) /
                     static_cast<double>(after->stamp - before.stamp);
    result.push_back({stamp, interpolate(before.pose, after->pose, s)});
  }
  return result;
}

std::unique_ptr<layouts::Writer> make_writer(const std::string& layout, const fs::path& folder,
                                             const layouts::Source& source,
                                             const std::string& sensor) {
  if (layout == "kitti") return layouts::make_kitti_writer(folder, source);
  if (layout == "mulran") return layouts::make_mulran_writer(folder, source);
  if (layout == "helipr") return layouts::make_helipr_writer(folder, source, sensor);
  if (layout == "nclt") return layouts::make_nclt_writer(folder, source);
  if (layout == "rosbag") return layouts::make_rosbag_writer(folder, source);
  if (layout == "rosbag2") return layouts::make_rosbag2_writer(folder, source);
  if (layout == "mcap") return layouts::make_mcap_writer(folder, source);
  if (layout == "livox") return layouts::make_livox_writer(folder, source);
  if (layout == "folder") return layouts::make_folder_writer(folder, source);
  std::string names;
  for (const std::string& name : layout_names()) names += (names.empty() ? "" : ", ") + name;
  throw InputError("--layout " + layout + " is unknown; known are " + names);
}

// A folder beside the final one, gone unless it is put in place.
class PartialFolder {
 public:
  explicit PartialFolder(const fs::path& folder) : final_(fs::absolute(folder).lexically_normal()) {
    if (!final_.has_filename()) final_ = final_.parent_path();
    std::error_code error;
    if (fs::exists(final_, error) && !fs::is_empty(final_, error)) {
      throw InputError(folder.string() + ": is there and not empty; choose a new folder");
    }
    partial_ = final_;
    partial_ += ".part" + std::to_string(::getpid());
    fs::create_directories(partial_, error);
    if (error) {
      throw InputError(folder.string() + ": cannot be written; choose a folder you may write to");
    }
  }
  ~PartialFolder() {
    std::error_code error;
    if (!partial_.empty()) fs::remove_all(partial_, error);
  }
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return partial_; }
  void commit() {
    std::error_code error;
    fs::remove(final_, error);  // an empty folder, if anything
    fs::rename(partial_, final_, error);
    if (error) throw InputError(final_.string() + ": cannot be put in place: " + error.message());
    partial_.clear();
  }

 private:
  fs::path final_, partial_;
};

}  // namespace

const std::vector<std::string>& layout_names() {
  static const std::vector<std::string> names = {"kitti",   "mulran", "helipr", "nclt", "rosbag",
                                                 "rosbag2", "mcap",   "folder", "livox"};
  return names;
}

void write_layout(Recording& recording, const std::string& layout, const fs::path& folder,
                  const std::string& sensor, const Progress& progress) {
  layouts::Source source;
  for (std::size_t i = 0; i < recording.size(); ++i) source.stamps.push_back(recording.stamp(i));
  source.period = recordings::scan_duration(source.stamps);
  source.ground_truth = ground_truth_at(recording, source.stamps);
  PartialFolder partial(folder);
  {
    const auto writer = make_writer(layout, partial.path(), source, sensor);
    for (std::size_t i = 0; i < recording.size(); ++i) {
      if (progress) progress("write", i, recording.size());
      writer->write(i, recording.read(i));
    }
    writer->finish();
  }
  partial.commit();
}

}  // namespace groundloop
