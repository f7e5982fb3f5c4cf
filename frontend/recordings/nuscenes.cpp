// nuScenes (Caesar et al., CVPR 2020): the data set's folder with its JSON tables. A recording is a
// scene: key frames and sweeps of LIDAR_TOP in the order of time, ego poses as ground truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/datasets.hpp"
#include "frontend/recordings/scan_files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

constexpr std::array kRecordFields = {"x", "y", "z", "intensity", "ring"};
constexpr const char* kFields = "float32 x y z intensity ring";
constexpr const char* kLidar = "LIDAR_TOP";

// Folders of tables: v1.0-mini, v1.0-trainval, ...
std::vector<fs::path> table_folders(const fs::path& root) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(root, error), end; !error && it != end; it.increment(error)) {
    std::error_code missing;
    if (it->path().filename().string().starts_with("v1.") &&
        fs::is_regular_file(it->path() / "sample_data.json", missing))
      found.push_back(it->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Calls use(row) for each row of a table; of a table of a gigabyte one row is in memory at a time.
void each_row(const fs::path& table, const std::function<void(const Json&)>& use) {
  std::uintmax_t size = 0;
  std::ifstream in = open_for_reading(table, size);
  const auto on_event = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth != 1 || event != Json::parse_event_t::object_end) return true;
    try {
      use(parsed);
    } catch (const InputError& e) {
      throw InputError(table.string() + ": " + e.what());
    }
    return false;
  };
  try {
    const Json rest = Json::parse(in, on_event);
    if (!rest.is_array()) throw InputError(table.string() + ": is no list of rows");
  } catch (const Json::exception& e) {
    std::string what = e.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw InputError(table.string() + ": cannot be read as one of nuScenes' tables (" +
                     what.substr(0, 200) + ")");
  }
}

std::vector<double> numbers(const Json& row, const char* key, std::size_t count) {
  const auto values = row.at(key).get<std::vector<double>>();
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (values.size() != count || !finite)
    throw InputError(std::string("'") + key + "' holds no " + std::to_string(count) + " numbers");
  return values;
}

// Columns translation (m) and rotation (w x y z).
Pose pose_of(const Json& row) {
  const std::vector<double> t = numbers(row, "translation", 3), q = numbers(row, "rotation", 4);
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-2))
    throw InputError("'rotation' has norm " + to_text(rotation.norm()) + ", expected 1");
  return {rotation.normalized(), Eigen::Vector3d(t[0], t[1], t[2])};
}

struct Sweep {
  Nanoseconds stamp = 0;
  fs::path file;
  std::string ego_pose, calibration;
};

class NuscenesRecording final : public ScanFiles {
 public:
  NuscenesRecording(const fs::path& root, const RecordingOptions& options)
      : ScanFiles(root, "nuscenes", options) {
    const fs::path tables = choose_scene(root, options.topic);
    read_sweeps(root, tables);
    check_lengths(layout_.packed_size, kFields);
    sweeps_.resize(files_.size());
    read_truth(tables);
    info_.sensor = "Velodyne HDL-32E";
    info_.stamp_source = "sample_data.json (us), the end of each turn";
    info_.fields = layout_.described();
    info_.attributes = layout_.attributes();
    info_.point_times = "none";
    info_.gaps = count_gaps(stamps_);
    info_.notes.push_back("Scene " + scene_ + " of " + tables.filename().string() + ".");
    info_.notes.emplace_back("Points have no times of their own; scans are taken as deskewed.");
  }

 private:
  // Finds the scene, and the folder of tables that knows it.
  fs::path choose_scene(const fs::path& root, const std::string& wanted) {
    std::vector<std::string> names;
    fs::path chosen;
    for (const fs::path& tables : table_folders(root)) {
      each_row(tables / "scene.json", [&](const Json& row) {
        const auto name = row.at("name").get<std::string>();
        names.push_back(name);
        if (!chosen.empty() || (!wanted.empty() && name != wanted)) return;
        scene_ = name;
        scene_token_ = row.at("token").get<std::string>();
        chosen = tables;
      });
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    if (!chosen.empty() && (!wanted.empty() || names.size() == 1)) return chosen;
    std::string list;
    constexpr std::size_t kNamed = 12;
    for (std::size_t i = 0; i < std::min(kNamed, names.size()); ++i)
      list += (i == 0 ? "" : ", ") + names[i];
    if (names.size() > kNamed) list += ", ... (" + std::to_string(names.size()) + " in all)";
    throw InputError(root.string() +
                     (wanted.empty() ? ": holds several scenes; choose one with --topic: "
                                     : ": has no scene " + wanted + "; choose one of ") +
                     (list.empty() ? "none is listed in scene.json" : list));
  }

  void read_sweeps(const fs::path& root, const fs::path& tables) {
    std::set<std::string> samples;
    each_row(tables / "sample.json", [&](const Json& row) {
      if (row.at("scene_token") == scene_token_) samples.insert(row.at("token").get<std::string>());
    });
    std::size_t missing = 0;
    each_row(tables / "sample_data.json", [&](const Json& row) {
      const auto name = row.at("filename").get<std::string>();
      if (name.find(kLidar) == std::string::npos ||
          samples.count(row.at("sample_token").get<std::string>()) == 0)
        return;
      const fs::path relative = fs::path(name).lexically_normal();
      if (relative.is_absolute() || relative.empty() || *relative.begin() == "..")
        throw InputError("file name '" + name + "' lies outside of the data set's folder");
      std::error_code error;
      if (!fs::is_regular_file(root / relative, error)) {
        ++missing;
        return;
      }
      const auto microseconds = row.at("timestamp").get<std::int64_t>();
      if (microseconds < 0 || microseconds > kFarthestStamp / 1000)
        throw InputError(std::to_string(microseconds) + " is no stamp in microseconds");
      sweeps_.push_back({microseconds * 1000, root / relative,
                         row.at("ego_pose_token").get<std::string>(),
                         row.at("calibrated_sensor_token").get<std::string>()});
    });
    std::sort(sweeps_.begin(), sweeps_.end(), [](const Sweep& a, const Sweep& b) {
      return a.stamp != b.stamp ? a.stamp < b.stamp : a.file < b.file;
    });
    const auto end = std::unique(sweeps_.begin(), sweeps_.end(),
                                 [](const Sweep& a, const Sweep& b) { return a.stamp == b.stamp; });
    info_.duplicates = static_cast<std::size_t>(sweeps_.end() - end);
    sweeps_.erase(end, sweeps_.end());
    for (const Sweep& sweep : sweeps_) {
      stamps_.push_back(sweep.stamp);
      files_.push_back(sweep.file);
    }
    if (files_.empty()) {
      throw InputError(root.string() + ": none of the scans of scene " + scene_ +
                       " is there; lay samples/LIDAR_TOP and sweeps/LIDAR_TOP beside the tables");
    }
    if (missing > 0) {
      info_.warnings.push_back(std::to_string(missing) +
                               " scans of the scene are listed but not there (sweeps/LIDAR_TOP?); "
                               "the others are used.");
    }
  }

  // World to ego to sensor, each at the sweep's own stamp.
  void read_truth(const fs::path& tables) {
    std::map<std::string, Pose> egos, sensors;
    for (const Sweep& sweep : sweeps_) {
      egos.emplace(sweep.ego_pose, Pose());
      sensors.emplace(sweep.calibration, Pose());
    }
    const auto gather = [&](const char* name, std::map<std::string, Pose>& poses) {
      std::size_t found = 0;
      each_row(tables / name, [&](const Json& row) {
        const auto it = poses.find(row.at("token").get<std::string>());
        if (it == poses.end()) return;
        it->second = pose_of(row);
        ++found;
      });
      if (found < poses.size())
        throw InputError((tables / name).string() + ": lacks " +
                         std::to_string(poses.size() - found) +
                         " rows that sample_data.json names");
    };
    gather("ego_pose.json", egos);
    gather("calibrated_sensor.json", sensors);
    for (const Sweep& sweep : sweeps_)
      ground_truth_.push_back(
          {sweep.stamp, egos.at(sweep.ego_pose) * sensors.at(sweep.calibration)});
    info_.notes.emplace_back(
        "Ground truth is ego_pose.json, brought to the LiDAR with calibrated_sensor.json.");
  }

  std::size_t decode(std::size_t index, Scan& scan) override {
    return decode_table(index, {layout_, record_count(index, layout_.packed_size, kFields)}, {},
                        scan);
  }

  const PointLayout layout_ = float_records(kRecordFields);
  std::string scene_, scene_token_;
  std::vector<Sweep> sweeps_;
};

// The data set's folder; also where its tables are named themselves.
fs::path root_of(const fs::path& path) {
  if (!table_folders(path).empty()) return path;
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error).lexically_normal();
  const fs::path self = absolute.has_filename() ? absolute : absolute.parent_path();
  if (self.filename().string().starts_with("v1.") &&
      fs::is_regular_file(self / "sample_data.json", error))
    return self.parent_path();
  return {};
}

}  // namespace

bool is_nuscenes(const fs::path& path) { return !root_of(path).empty(); }

std::unique_ptr<Recording> open_nuscenes(const fs::path& path, const RecordingOptions& options) {
  const fs::path root = root_of(path);
  if (root.empty())
    throw InputError(path.string() + ": holds no folder v1.0-* with nuScenes' tables");
  return std::make_unique<NuscenesRecording>(root, options);
}

}  // namespace groundloop::recordings
