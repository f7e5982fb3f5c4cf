// KITTI raw (Geiger et al., IJRR 2013): scans as the sensor turned, with the times at which each
// turn began and ended, and GPS/IMU packets as ground truth.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/datasets.hpp"
#include "frontend/recordings/ground_truth.hpp"
#include "frontend/recordings/scan_files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kRecord = 4 * sizeof(float);

// "2011-09-26 13:02:25.964389445" in UTC.
bool parse_date(const std::string& line, Nanoseconds& stamp) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, used = 0;
  if (std::sscanf(line.c_str(), "%4d-%2d-%2d %2d:%2d:%n", &year, &month, &day, &hour, &minute,
                  &used) != 5 ||
      used == 0) {
    return false;
  }
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  Nanoseconds seconds = 0;
  std::string rest = line.substr(static_cast<std::size_t>(used));
  while (!rest.empty() && (rest.back() == '\r' || rest.back() == ' ')) rest.pop_back();
  if (!date.ok() || year < 1970 || year > 2100 || hour < 0 || minute < 0 || hour > 23 ||
      minute > 59 || !parse_seconds(rest, seconds) || seconds < 0 || seconds > 61'000'000'000)
    return false;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  stamp = ((static_cast<Nanoseconds>(days) * 24 + hour) * 60 + minute) * 60'000'000'000 + seconds;
  return true;
}

std::vector<Nanoseconds> read_dates(const fs::path& file, std::size_t scans) {
  std::istringstream text(read_text(file));
  std::vector<Nanoseconds> stamps;
  std::string line;
  while (std::getline(text, line)) {
    const std::string where = file.string() + ":" + std::to_string(stamps.size() + 1) + ": ";
    Nanoseconds stamp = 0;
    if (!parse_date(line, stamp)) {
      throw InputError(where + "'" + line.substr(0, 40) +
                       "' is no date and time like 2011-09-26 13:02:25.964389445");
    }
    if (!stamps.empty() && stamp <= stamps.back()) {
      throw InputError(where + "the stamp stands still or goes back; stamps must increase");
    }
    stamps.push_back(stamp);
  }
  if (stamps.size() < scans) {
    throw InputError(file.string() + ": " + std::to_string(stamps.size()) + " stamps for " +
                     std::to_string(scans) + " scans; it needs one line a scan");
  }
  return stamps;
}

// T_velo_imu of calib_imu_to_velo.txt: lines "R: 9 numbers" and "T: 3 numbers".
Pose read_imu_calibration(const fs::path& file) {
  std::istringstream text(read_text(file));
  double matrix[12] = {};
  bool has_rotation = false, has_translation = false;
  std::string line;
  while (std::getline(text, line)) {
    std::istringstream fields(line);
    std::string key;
    fields >> key;
    if (key == "R:") {
      for (int i = 0; i < 9; ++i) fields >> matrix[4 * (i / 3) + i % 3];
      has_rotation = !fields.fail();
    } else if (key == "T:") {
      for (int i = 0; i < 3; ++i) fields >> matrix[4 * i + 3];
      has_translation = !fields.fail();
    }
  }
  if (!has_rotation || !has_translation) {
    throw InputError(file.string() + ": needs lines 'R:' of 9 and 'T:' of 3 numbers");
  }
  return pose_from_matrix(matrix, file.string() + ": ");
}

fs::path velodyne_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path / "velodyne_points" / "data", error) ? path / "velodyne_points"
                                                                    : fs::path();
}

class KittiRawRecording final : public ScanFiles {
 public:
  KittiRawRecording(const fs::path& drive, const RecordingOptions& options)
      : ScanFiles(drive, "kitti_raw", velodyne_folder(drive) / "data", ".bin", options) {
    const fs::path folder = velodyne_folder(drive);
    std::error_code error;
    info_.sensor = "Velodyne HDL-64E";
    info_.fields = {"x", "y", "z", "intensity"};
    info_.attributes.intensity = true;
    const bool whole = fs::exists(folder / "timestamps_start.txt", error);
    const fs::path file = folder / (whole ? "timestamps_start.txt" : "timestamps.txt");
    const std::vector<Nanoseconds> listed = read_dates(file, files_.size());
    const StampTable table = match_stamps(files_, file, listed);
    stamps_ = table.stamps;
    info_.stamp_source = file.filename().string();
    info_.gaps = count_gaps(stamps_);
    const Nanoseconds period = median_period(stamps_);
    duration_s_.assign(files_.size(), 1e-9 * static_cast<double>(period));
    if (whole && fs::exists(folder / "timestamps_end.txt", error)) {
      const std::vector<Nanoseconds> ends =
          read_dates(folder / "timestamps_end.txt", files_.size());
      for (std::size_t i = 0; i < files_.size(); ++i) {
        const Nanoseconds duration = ends.at(table.rows[i]) - stamps_[i];
        if (duration > 0 && duration < 2 * period) {
          duration_s_[i] = 1e-9 * static_cast<double>(duration);
        }
      }
    }
    if (!whole) {
      // timestamps.txt names the instant at which the laser looked ahead, half a turn later.
      for (Nanoseconds& stamp : stamps_) stamp -= period / 2;
    }
    info_.point_times = "azimuth: the turn goes clockwise from straight behind";
    load_ground_truth(drive);
  }

 private:
  void load_ground_truth(const fs::path& drive) {
    std::error_code error;
    if (!fs::is_directory(drive / "oxts" / "data", error)) return;
    const fs::path calibration =
        (fs::absolute(drive) / ".." / "calib_imu_to_velo.txt").lexically_normal();
    Pose T_lidar_imu;
    if (fs::exists(calibration, error)) {
      T_lidar_imu = read_imu_calibration(calibration);
    } else {
      info_.notes.emplace_back(
          "There is no ../calib_imu_to_velo.txt; ground truth is that of the GPS/IMU.");
    }
    const std::vector<fs::path> packets = list_files(drive / "oxts" / "data", ".txt");
    const std::vector<Nanoseconds> stamps =
        read_dates(drive / "oxts" / "timestamps.txt", packets.size());
    double scale = 0.0;
    for (std::size_t i = 0; i < packets.size(); ++i) {
      const NumberTable table = read_numbers(packets[i]);
      if (table.columns < 6) {
        throw InputError(packets[i].string() + ": " + std::to_string(table.columns) +
                         " numbers; a packet has 30 (latitude, longitude, altitude, roll, ...)");
      }
      const std::vector<double>& p = table.rows.front();
      // Mercator projection with the scale of the first latitude, as the development kit has it.
      constexpr double kEarth = 6378137.0;
      if (i == 0) scale = std::cos(p[0] * kRadiansPerDegree);
      const Eigen::Vector3d t(
          scale * p[1] * kRadiansPerDegree * kEarth,
          scale * kEarth * std::log(std::tan((90.0 + p[0]) * kRadiansPerDegree / 2.0)), p[2]);
      const Pose T_world_imu(from_roll_pitch_yaw(p[3], p[4], p[5]), t);
      ground_truth_.push_back({stamps[i], T_world_imu * T_lidar_imu.inverse()});
    }
    info_.notes.emplace_back("Ground truth is that of the GPS/IMU (oxts).");
  }

  std::size_t decode(std::size_t index, Scan& scan) override {
    const std::size_t count = record_count(index, kRecord, "float32 x y z intensity");
    const double half = 0.5 * duration_s_[index];
    decode_table(index, {layout_, count}, {}, scan);
    scan.times.reserve(scan.points.size());
    for (const Eigen::Vector3f& p : scan.points) {
      const double azimuth = std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x()));
      scan.times.push_back(static_cast<float>(half * (1.0 - azimuth / std::numbers::pi)));
    }
    return count;
  }

  const PointLayout layout_ = float_records(kKittiFields);
  std::vector<double> duration_s_;
};

}  // namespace

bool is_kitti_raw(const fs::path& path) { return !velodyne_folder(path).empty(); }

std::unique_ptr<Recording> open_kitti_raw(const fs::path& path, const RecordingOptions& options) {
  if (!is_kitti_raw(path))
    throw InputError(path.string() + ": no folder velodyne_points/data here");
  return std::make_unique<KittiRawRecording>(path, options);
}

}  // namespace groundloop::recordings
