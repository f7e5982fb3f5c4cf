// Layouts of one file a scan: KITTI odometry, MulRan, HeLiPR and plain folders.
#include <array>
#include <cmath>
#include <cstdio>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/simulation/layouts/byte_writer.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"

namespace groundloop::layouts {
namespace fs = std::filesystem;

namespace {

std::string six_digits(std::size_t number) {
  std::string text = std::to_string(number);
  return text.size() < 6 ? std::string(6 - text.size(), '0') + text : text;
}

std::string matrix_text(const Pose& pose, char separator) {
  const Eigen::Matrix4d m = pose.matrix();
  std::string text;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      if (r + c > 0) text += separator;
      text += to_text(m(r, c));
    }
  }
  return text;
}

double time_of(const Scan& scan, std::size_t i) {
  return scan.times.empty() ? 0.0 : static_cast<double>(scan.times[i]);
}

// ---- KITTI
// ---------------------------------------------------------------------------------------

class KittiWriter final : public Writer {
 public:
  KittiWriter(const fs::path& folder, const Source& source)
      : sequence_(folder / "sequences" / "00"), period_(1e-9 * static_cast<double>(source.period)) {
    fs::create_directories(sequence_ / "velodyne");
    std::string times;
    for (const Nanoseconds stamp : source.stamps) times += seconds_text(stamp) + "\n";
    write_bytes(sequence_ / "times.txt", times);
    // The camera's axes as KITTI has them (x right, y down, z ahead), a little ahead and below.
    Eigen::Matrix3d axes;
    axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    const Pose T_camera_lidar(axes, Eigen::Vector3d(0.0, -0.08, -0.27));
    std::string calibration;
    for (const char* camera : {"P0", "P1", "P2", "P3"}) {
      calibration += std::string(camera) + ": 1 0 0 0 0 1 0 0 0 0 1 0\n";
    }
    write_bytes(sequence_ / "calib.txt",
                calibration + "Tr: " + matrix_text(T_camera_lidar, ' ') + "\n");
    if (source.ground_truth.empty()) return;
    fs::create_directories(folder / "poses");
    const Pose first =
        source.ground_truth.front().pose * T_camera_lidar.inverse();  // T_world_camera
    std::string poses;
    for (const StampedPose& sample : source.ground_truth) {
      poses += matrix_text(first.inverse() * sample.pose * T_camera_lidar.inverse(), ' ') + "\n";
    }
    write_bytes(folder / "poses" / "00.txt", poses);
  }

  void write(std::size_t index, const Scan& scan) override {
    ByteWriter points, times;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3f& p = scan.points[i];
      points.put(p.x()).put(p.y()).put(p.z()).put(0.0F);
      if (scan.times.empty()) continue;
      const double share = time_of(scan, i) / period_;
      if (share < -1e-4 || share > 1.0 + 1e-4) {
        throw InputError("scan " + std::to_string(index) + ": a point " + to_text(share * period_) +
                         " s from the stamp is outside of the scan's " + to_text(period_) +
                         " s; KITTI's layout cannot hold it");
      }
      times.put(static_cast<float>(share));
    }
    const std::string name = six_digits(index) + ".bin";
    write_bytes(sequence_ / "velodyne" / name, points.view());
    if (scan.times.empty()) return;
    fs::create_directories(sequence_ / "times_per_point");
    write_bytes(sequence_ / "times_per_point" / name, times.view());
  }

 private:
  fs::path sequence_;
  double period_;
};

// ---- MulRan
// --------------------------------------------------------------------------------------

class MulranWriter final : public Writer {
 public:
  MulranWriter(const fs::path& folder, const Source& source)
      : scans_(folder / "sensor_data" / "Ouster") {
    fs::create_directories(scans_);
    if (source.ground_truth.empty()) return;
    const Pose T_lidar_base = recordings::mulran_base_from_lidar().inverse();
    std::string text;
    for (const StampedPose& sample : source.ground_truth) {
      text +=
          std::to_string(sample.stamp) + "," + matrix_text(sample.pose * T_lidar_base, ',') + "\n";
    }
    write_bytes(folder / "global_pose.csv", text);
  }

  // 1024 columns of 64 records, of which those without a return are zero. A scan that does not fit
  // (no times, more points a column) is written without the grid, as broken scans of MulRan are.
  void write(std::size_t, const Scan& scan) override {
    constexpr std::size_t kRows = recordings::kMulranRows, kColumns = recordings::kMulranColumns;
    std::vector<std::array<float, 4>> grid(kRows * kColumns, {0, 0, 0, 0});
    std::array<std::size_t, kColumns> filled{};
    bool fits = !scan.times.empty();
    for (std::size_t i = 0; fits && i < scan.points.size(); ++i) {
      // A thousandth of a column makes up for times rounded down.
      const double column =
          std::floor(time_of(scan, i) / recordings::kMulranTurn * kColumns + 1e-3);
      fits = column >= 0.0 && column < kColumns;
      if (!fits) break;
      const auto c = static_cast<std::size_t>(column);
      fits = filled[c] < kRows;
      if (!fits) break;
      const Eigen::Vector3f& p = scan.points[i];
      grid[c * kRows + filled[c]++] = {p.x(), p.y(), p.z(), 0.0F};
    }
    ByteWriter bytes;
    if (fits) {
      bytes.put_bytes(grid.data(), grid.size() * sizeof grid[0]);
    } else {
      for (const Eigen::Vector3f& p : scan.points) bytes.put(p.x()).put(p.y()).put(p.z()).put(0.0F);
    }
    write_bytes(scans_ / (std::to_string(scan.stamp) + ".bin"), bytes.view());
  }

 private:
  fs::path scans_;
};

// ---- HeLiPR
// --------------------------------------------------------------------------------------

class HeliprWriter final : public Writer {
 public:
  HeliprWriter(const fs::path& folder, const Source& source, const std::string& sensor)
      : scans_(folder / "LiDAR" / sensor), sensor_(sensor) {
    if (sensor != "Ouster" && sensor != "Velodyne" && sensor != "Avia" && sensor != "Aeva") {
      throw InputError("sensor '" + sensor + "' is none of HeLiPR's: Ouster, Velodyne, Avia, Aeva");
    }
    fs::create_directories(scans_);
    if (source.ground_truth.empty()) return;
    fs::create_directories(folder / "LiDAR_GT");
    std::string text;
    for (const StampedPose& sample : source.ground_truth) {
      const Eigen::Quaterniond& q = sample.pose.rotation;
      text += std::to_string(sample.stamp);
      for (const double v : {sample.pose.translation.x(), sample.pose.translation.y(),
                             sample.pose.translation.z(), q.x(), q.y(), q.z(), q.w()}) {
        text += " " + to_text(v);
      }
      text += "\n";
    }
    write_bytes(folder / "LiDAR_GT" / (sensor + "_gt.txt"), text);
  }

  void write(std::size_t index, const Scan& scan) override {
    ByteWriter bytes;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3f& p = scan.points[i];
      const double seconds = time_of(scan, i);
      if (seconds < 0.0 || seconds > 2.0) {
        throw InputError("scan " + std::to_string(index) + ": a point " + to_text(seconds) +
                         " s from the stamp; HeLiPR's records count nanoseconds from it");
      }
      const auto ns = static_cast<std::uint32_t>(std::lround(seconds * 1e9));
      bytes.put(p.x()).put(p.y()).put(p.z());
      if (sensor_ == "Ouster") {
        // intensity, t, reflectivity, ring, ambient
        bytes.put(0.0F).put(ns).put<std::uint16_t>(0).put<std::uint16_t>(0).put<std::uint16_t>(0);
      } else if (sensor_ == "Velodyne") {
        // intensity, ring, time
        bytes.put(0.0F).put<std::uint16_t>(0).put(static_cast<float>(seconds));
      } else if (sensor_ == "Avia") {
        // reflectivity, tag, line, offset_time
        bytes.put<std::uint8_t>(0).put<std::uint8_t>(0).put<std::uint8_t>(0).put(ns);
      } else {
        // reflectivity, velocity, time_offset_ns, line_index, and intensity in later recordings
        bytes.put(0.0F).put(0.0F).put(static_cast<std::int32_t>(ns)).put<std::uint8_t>(0);
        if (scan.stamp > recordings::kHeliprAevaWithoutIntensity) bytes.put(0.0F);
      }
    }
    write_bytes(scans_ / (std::to_string(scan.stamp) + ".bin"), bytes.view());
  }

 private:
  fs::path scans_;
  std::string sensor_;
};

// ---- folder
// --------------------------------------------------------------------------------------

class FolderWriter final : public Writer {
 public:
  FolderWriter(const fs::path& folder, const Source& source) : folder_(folder) {
    if (!source.ground_truth.empty()) write_tum(folder / "ground_truth.tum", source.ground_truth);
  }

  void write(std::size_t, const Scan& scan) override {
    const bool timed = !scan.times.empty();
    const std::string n = std::to_string(scan.points.size());
    ByteWriter bytes;
    bytes.put_text("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n");
    bytes.put_text(timed ? "FIELDS x y z t\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
                         : "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n");
    bytes.put_text("WIDTH " + n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n +
                   "\nDATA binary\n");
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3f& p = scan.points[i];
      bytes.put(p.x()).put(p.y()).put(p.z());
      if (timed) bytes.put(scan.times[i]);
    }
    write_bytes(folder_ / (std::to_string(scan.stamp) + ".pcd"), bytes.view());
  }

 private:
  fs::path folder_;
};

}  // namespace

std::unique_ptr<Writer> make_kitti_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<KittiWriter>(folder, source);
}
std::unique_ptr<Writer> make_mulran_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<MulranWriter>(folder, source);
}
std::unique_ptr<Writer> make_helipr_writer(const fs::path& folder, const Source& source,
                                           const std::string& sensor) {
  return std::make_unique<HeliprWriter>(folder, source, sensor);
}
std::unique_ptr<Writer> make_folder_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<FolderWriter>(folder, source);
}

}  // namespace groundloop::layouts
