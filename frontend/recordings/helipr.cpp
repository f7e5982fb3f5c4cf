// HeLiPR (Jung et al., IJRR 2023): four LiDARs, a packed little-endian record for each.
#include <algorithm>
#include <array>
#include <set>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/datasets.hpp"
#include "frontend/recordings/ground_truth.hpp"
#include "frontend/recordings/scan_files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr double kLongestScan = 0.15;  // s; all four turn, or frame, ten times a second
constexpr std::array<const char*, 4> kSensors = {"Ouster", "Velodyne", "Avia", "Aeva"};

struct Found {
  fs::path root;
  std::string sensor;
};

// Sensors of a root (PATH/LiDAR/SENSOR), of PATH = ROOT/LiDAR, or the one that PATH is.
std::vector<Found> find_sensors(const fs::path& path) {
  std::vector<Found> found;
  std::error_code error;
  const fs::path absolute = fs::absolute(path).lexically_normal();
  const fs::path self = absolute.has_filename() ? absolute : absolute.parent_path();
  for (const char* sensor : kSensors) {
    if (fs::is_directory(self / "LiDAR" / sensor, error)) found.push_back({self, sensor});
    if (self.filename() == "LiDAR" && fs::is_directory(self / sensor, error)) {
      found.push_back({self.parent_path(), sensor});
    }
    if (self.filename() == sensor && self.parent_path().filename() == "LiDAR") {
      found.push_back({self.parent_path().parent_path(), sensor});
    }
  }
  return found;
}

PointLayout layout_of(const std::string& sensor, Nanoseconds stamp) {
  PointLayout layout;
  for (const char* name : {"x", "y", "z"}) layout.append(name, FieldType::float32);
  if (sensor == "Ouster") {
    layout.append("intensity", FieldType::float32);
    layout.append("t", FieldType::uint32);
    layout.append("reflectivity", FieldType::uint16);
    layout.append("ring", FieldType::uint16);
    layout.append("ambient", FieldType::uint16);
  } else if (sensor == "Velodyne") {
    layout.append("intensity", FieldType::float32);
    layout.append("ring", FieldType::uint16);
    layout.append("time", FieldType::float32);
  } else if (sensor == "Avia") {
    layout.append("reflectivity", FieldType::uint8);
    layout.append("tag", FieldType::uint8);
    layout.append("line", FieldType::uint8);
    layout.append("offset_time", FieldType::uint32);
  } else {
    layout.append("reflectivity", FieldType::float32);
    layout.append("velocity", FieldType::float32);
    layout.append("time_offset_ns", FieldType::int32);
    layout.append("line_index", FieldType::uint8);
    if (stamp > kHeliprAevaWithoutIntensity) layout.append("intensity", FieldType::float32);
  }
  layout.set_records(0);
  return layout;
}

class HeliprRecording final : public ScanFiles {
 public:
  HeliprRecording(const Found& found, const RecordingOptions& options)
      : ScanFiles(found.root, "helipr", found.root / "LiDAR" / found.sensor, ".bin", options),
        sensor_(found.sensor) {
    take_stamps_from_names(1, "ns");
    const auto check = [&](std::size_t i) {
      check_length(i, layout_of(sensor_, stamps_[i]).packed_size, record_name().c_str());
    };
    for (std::size_t i = 0; i + 1 < files_.size(); ++i) check(i);
    check_last(check);
    const PointLayout layout = layout_of(sensor_, stamps_.front());
    info_.sensor = sensor_;
    info_.fields = layout.described();
    info_.attributes = layout.attributes();
    // The dataset says what its times are; nothing is inferred.
    const PointField* field = find_time_field(layout);
    const bool seconds = sensor_ == "Velodyne";
    times_.field = field->name;
    times_.type = field->type;
    times_.seconds_per_unit = seconds ? 1.0 : 1e-9;
    times_.unit = seconds ? "s" : "ns";
    times_.longest_scan_s = kLongestScan;
    info_.point_times = times_.described();
    const fs::path truth = found.root / "LiDAR_GT" / (sensor_ + "_gt.txt");
    std::error_code error;
    if (fs::exists(truth, error)) {
      ground_truth_ = read_ground_truth(truth, all_stamps());
      info_.notes.push_back("Ground truth is LiDAR_GT/" + sensor_ +
                            "_gt.txt, of the LiDAR itself.");
    }
  }

 private:
  [[nodiscard]] std::string record_name() const { return "HeLiPR's " + sensor_ + " record"; }

  std::size_t decode(std::size_t index, Scan& scan) override {
    PointTable table{layout_of(sensor_, stamps_[index]), 0};
    table.count = record_count(index, table.layout.packed_size, record_name().c_str());
    return decode_table(index, table, {&times_, {}, nullptr}, scan);
  }

  std::string sensor_;
  TimeModel times_;
};

}  // namespace

bool is_helipr(const fs::path& path) { return !find_sensors(path).empty(); }

std::unique_ptr<Recording> open_helipr(const fs::path& path, const RecordingOptions& options) {
  const std::string& sensor = options.topic;
  const std::vector<Found> found = find_sensors(path);
  if (found.empty()) throw InputError(path.string() + ": no folder LiDAR/SENSOR here");
  std::string list;
  for (const Found& f : found) {
    if (f.sensor == sensor || (sensor.empty() && found.size() == 1)) {
      return std::make_unique<HeliprRecording>(f, options);
    }
    list += (list.empty() ? "" : ", ") + f.sensor + " (" +
            std::to_string(list_files(f.root / "LiDAR" / f.sensor, ".bin").size()) + " scans)";
  }
  throw InputError(
      path.string() +
      (sensor.empty() ? ": has several sensors: " : ": has no sensor '" + sensor + "'; it has ") +
      list + "; choose one with --topic");
}

}  // namespace groundloop::recordings
