#include "frontend/recordings/kitti.hpp"

#include <cmath>
#include <cstring>
#include <sstream>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/scan_files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kRecord = 4 * sizeof(float);
constexpr const char* kFields = "float32 x y z intensity";

bool is_sequence(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "velodyne", error);
}

class KittiRecording final : public ScanFiles {
 public:
  KittiRecording(const fs::path& sequence, const RecordingOptions& options)
      : ScanFiles(sequence, "kitti", sequence / "velodyne", ".bin", options) {
    std::error_code error;
    info_.fields = {"x", "y", "z", "intensity"};
    info_.attributes.intensity = true;
    std::vector<std::size_t> rows;
    std::size_t row_count = files_.size();
    if (fs::exists(sequence / "times.txt", error)) {
      const std::vector<Nanoseconds> listed = read_stamp_file(sequence / "times.txt");
      StampTable table = match_stamps(files_, sequence / "times.txt", listed);
      stamps_ = std::move(table.stamps);
      rows = std::move(table.rows);
      row_count = listed.size();
      info_.stamp_source = "times.txt";
    } else {
      stamps_ = assumed_stamps(files_.size());
      for (std::size_t i = 0; i < files_.size(); ++i) rows.push_back(i);
      info_.stamp_source = "assumed 10 Hz";
      info_.notes.emplace_back("There is no times.txt; 10 scans a second are assumed.");
    }
    check_lengths(kRecord, kFields);
    info_.gaps = count_gaps(stamps_);
    duration_ = scan_duration(stamps_);
    if (fs::is_directory(sequence / "times_per_point", error)) {
      times_folder_ = sequence / "times_per_point";
      check_time_files();
      info_.point_times = "times_per_point, share of " +
                          to_text(1e-9 * static_cast<double>(duration_)) + " s from the stamp";
    } else {
      info_.point_times = "none";
      info_.notes.emplace_back("Scans have no per-point times and are taken as deskewed.");
    }
    load_ground_truth(sequence, rows, row_count);
  }

 private:
  void check_time_files() const {
    for (const fs::path& scan : files_) {
      const fs::path file = times_folder_ / scan.filename();
      std::error_code error;
      (void)fs::file_size(file, error);  // its length is checked with its scan's
      if (error) throw InputError(file.string() + ": cannot be read: " + error.message());
    }
  }

  static void check_time_bytes(const fs::path& file, std::uintmax_t bytes, std::size_t points) {
    if (bytes == points * sizeof(float)) return;
    throw InputError(file.string() + ": " + std::to_string(bytes) + " bytes for a scan of " +
                     std::to_string(points) + " points; it needs one float32 a point");
  }

  void load_ground_truth(const fs::path& sequence, const std::vector<std::size_t>& rows,
                         std::size_t row_count) {
    const fs::path absolute = fs::absolute(sequence).lexically_normal();
    const fs::path name =
        absolute.has_filename() ? absolute.filename() : absolute.parent_path().filename();
    const fs::path file = sequence / ".." / ".." / "poses" / (name.string() + ".txt");
    std::error_code error;
    if (!fs::exists(file, error)) return;
    const std::vector<Pose> poses = read_kitti_poses(file.lexically_normal());
    if (poses.size() != row_count && poses.size() != files_.size()) {
      throw InputError(file.lexically_normal().string() + ": " + std::to_string(poses.size()) +
                       " poses for " + std::to_string(files_.size()) +
                       " scans; ground truth needs one line a scan");
    }
    Pose T_camera_lidar;
    if (fs::exists(sequence / "calib.txt", error)) {
      T_camera_lidar = read_kitti_calibration(sequence / "calib.txt");
    } else {
      info_.notes.emplace_back(
          "There is no calib.txt; the poses are taken to be of the LiDAR itself.");
    }
    const Pose T_lidar_camera = T_camera_lidar.inverse();
    for (std::size_t i = 0; i < files_.size(); ++i) {
      const Pose& T_world_camera = poses[poses.size() == row_count ? rows[i] : i];
      ground_truth_.push_back({stamps_[i], T_lidar_camera * T_world_camera * T_camera_lidar});
    }
  }

  void read_times(std::size_t index, std::size_t count) {
    const fs::path file = times_folder_ / files_[index].filename();
    read_file_into(file, time_buffer_);
    check_time_bytes(file, time_buffer_.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      // NaN passes here: its point is dropped with it.
      if (share(i) < -1e-3F || share(i) > 1.0F + 1e-3F) {
        throw InputError(file.string() + ": time " + to_text(static_cast<double>(share(i))) +
                         " of point " + std::to_string(i) +
                         " is outside [0, 1] of the scan's duration");
      }
    }
  }

  [[nodiscard]] float share(std::size_t record) const {
    float value = 0.0F;
    std::memcpy(&value, time_buffer_.data() + record * sizeof value, sizeof value);
    return value;
  }

  std::size_t decode(std::size_t index, Scan& scan) override {
    const std::size_t count = record_count(index, kRecord, kFields);
    decode_table(index, {layout_, count}, {nullptr, {}, &records_}, scan);
    if (times_folder_.empty()) return count;
    read_times(index, count);
    const auto seconds = static_cast<float>(1e-9 * static_cast<double>(duration_));
    for (const std::uint32_t record : records_) scan.times.push_back(share(record) * seconds);
    remove_points(scan, [&](std::size_t i) { return std::isnan(scan.times[i]); });
    return count;
  }

  const PointLayout layout_ = float_records(kKittiFields);
  std::vector<std::uint32_t> records_;
  Nanoseconds duration_ = 0;
  fs::path times_folder_;
  std::vector<std::byte> time_buffer_;
};

}  // namespace

fs::path find_kitti_sequence(const fs::path& path) {
  if (is_sequence(path)) return path;
  std::error_code error;
  // The folder of scans itself.
  const fs::path absolute = fs::absolute(path).lexically_normal();
  const fs::path self = absolute.has_filename() ? absolute : absolute.parent_path();
  if (self.filename() == "velodyne" && fs::exists(self.parent_path() / "times.txt", error)) {
    return self.parent_path();
  }
  const fs::path parent = fs::is_directory(path / "sequences", error) ? path / "sequences" : path;
  std::vector<fs::path> found;
  for (fs::directory_iterator it(parent, error), end; !error && it != end; it.increment(error)) {
    if (is_sequence(it->path())) found.push_back(it->path());
  }
  if (found.empty()) return {};
  std::sort(found.begin(), found.end());
  if (found.size() > 1) {
    std::string names;
    for (const fs::path& sequence : found) {
      names += (names.empty() ? "" : ", ") + sequence.filename().string();
    }
    throw InputError(path.string() + ": holds several sequences (" + names +
                     "); name the folder of one, e.g. " + found.front().string());
  }
  return found.front();
}

Pose read_kitti_calibration(const fs::path& file) {
  std::istringstream text(read_text(file));
  std::string line;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    std::istringstream fields(line);
    std::string key;
    fields >> key;
    if (key != "Tr:" && key != "Tr" && key != "Tr_velo_to_cam:") continue;
    const std::string where = file.string() + ":" + std::to_string(number) + ": ";
    double rows[12];
    for (double& value : rows) {
      std::string field;
      if (!(fields >> field) || !parse_double(field, value)) {
        throw InputError(where + "'" + key + "' needs 12 numbers, a 3x4 matrix row by row");
      }
    }
    return pose_from_matrix(rows, where);
  }
  throw InputError(file.string() +
                   ": no line 'Tr:', which brings the poses from the camera to the LiDAR");
}

std::unique_ptr<Recording> open_kitti(const fs::path& sequence, const RecordingOptions& options) {
  return std::make_unique<KittiRecording>(sequence, options);
}

}  // namespace groundloop::recordings
