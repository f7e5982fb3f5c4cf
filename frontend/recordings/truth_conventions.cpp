#include "frontend/recordings/truth_conventions.hpp"

#include <algorithm>
#include <array>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/ground_truth.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

struct Convention {
  const char* begins;  ///< of the file's name
  const char* ends;
  const char* dataset;
  std::array<double, 7> T_tracked_lidar;  ///< x y z (m), quaternion x y z w
};

// Rotations are by whole or half right angles; they were published in few digits.
constexpr double kHalf = 0.70710678118654752;
constexpr std::array kConventions = {
    // The left camera of the stereo pair; z by 135 degrees (0, 0, 0.924, 0.383).
    Convention{"registered_poses.",
               "csv",
               "Newer College (stereo)",
               {-0.084, -0.025, 0.050, 0.0, 0.0, 0.92387953251128674, 0.38268343236508978}},
    // The base below the LiDAR.
    Convention{"gt-nc-", "", "Newer College (multi-camera)", {0.001, 0.0, 0.091, 0, 0, 0, 1}},
    Convention{"gt_state_", "", "Newer College (multi-camera)", {0.001, 0.0, 0.091, 0, 0, 0, 1}},
    // The IMU.
    Convention{"exp", "_imu.txt", "Hilti 2022", {-0.001, -0.00855, 0.055, kHalf, -kHalf, 0, 0}},
    // The base below the LiDAR, turned by half a turn.
    Convention{"gt-tum.", "", "Oxford Spires", {0.0, 0.0, 0.124, 0, 0, 1, 0}},
};

Pose pose_of(const std::array<double, 7>& v) {
  return {Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized(),
          Eigen::Vector3d(v[0], v[1], v[2])};
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// "exp_04_x_imu" of "exp04_x": some of Hilti's names have one line more.
std::string without_lines(std::string name) {
  std::erase(name, '_');
  return name;
}

// Hilti's recordings lie in one folder, each with a truth of its own; elsewhere a folder has one.
bool is_of(const Convention& convention, const std::string& truth, const fs::path& recording) {
  if (std::string_view(convention.dataset) != "Hilti 2022") return true;
  const std::string stem =
      without_lines(truth.substr(0, truth.size() - std::string_view("_imu.txt").size()));
  if (stem == without_lines(recording.stem().string())) return true;
  std::error_code error;
  if (!fs::is_directory(recording, error)) return false;
  const std::vector<fs::path> bags = list_files(recording, ".bag");
  return bags.size() == 1 && stem == without_lines(bags.front().stem().string());
}

std::optional<FoundTruth> by_convention(const fs::path& folder, const fs::path& recording) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return std::nullopt;
  for (const char* extension : {".csv", ".txt"}) {
    for (const fs::path& file : list_files(folder, extension)) {
      const std::string name = file.filename().string();
      for (const Convention& c : kConventions) {
        if (name.starts_with(c.begins) && name.ends_with(c.ends) && is_of(c, name, recording))
          return FoundTruth{file, c.dataset, pose_of(c.T_tracked_lidar)};
      }
    }
  }
  return std::nullopt;
}

// A row: GPS time (us), easting, northing, altitude, three velocities, roll, pitch, heading, three
// rates. The rotation is Rx(-roll) Ry(-pitch) Rz(-heading), as the data set's own tools have it.
Trajectory read_boreas(const fs::path& file) {
  const NumberTable table = read_numbers(file);
  if (table.columns != 13) {
    throw InputError(file.string() + ": " + std::to_string(table.columns) +
                     " columns; expected 13 (GPSTime, easting, ... of Applanix)");
  }
  Trajectory poses;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::vector<double>& row = table.rows[i];
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(-row[7], Eigen::Vector3d::UnitX()) *
                                        Eigen::AngleAxisd(-row[8], Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(-row[9], Eigen::Vector3d::UnitZ());
    poses.push_back({stamp_of_row(file, table, i, 1000),
                     Pose(rotation, Eigen::Vector3d(row[1], row[2], row[3]))});
  }
  return poses;
}

std::size_t files_like(const fs::path& folder, const fs::path& file) {
  return list_files(folder, file.extension().string()).size();
}

}  // namespace

std::optional<FoundTruth> find_truth(const fs::path& recording) {
  std::error_code error;
  const fs::path absolute = fs::absolute(recording, error).lexically_normal();
  const fs::path self = absolute.has_filename() ? absolute : absolute.parent_path();
  const bool file = is_file(self);
  const fs::path own = file ? self.parent_path() : self;
  // Where a data set puts it; the topmost folder that is looked into is that of the sequence.
  fs::path folder = own;
  for (int up = 0; up < 3 && folder.has_relative_path(); ++up, folder = folder.parent_path()) {
    if (is_file(folder / "applanix" / "lidar_poses.csv"))
      return FoundTruth{folder / "applanix" / "lidar_poses.csv", "Boreas", Pose(), true};
    for (const fs::path& place :
         {folder, folder / "ground_truth", folder / "processed" / "trajectory"}) {
      if (auto found = by_convention(place, self)) return found;
    }
  }
  if (file) {
    for (const char* extension : {".txt", ".tum", ".csv"}) {
      const fs::path same = own / (self.stem().string() + extension);
      if (is_file(same)) return FoundTruth{same, {}, Pose()};
    }
    // A usual name is of the recording only where there is no other.
    if (files_like(own, self) != 1) return std::nullopt;
  }
  std::vector<fs::path> places = {own};
  if (!file) places.push_back(own.parent_path());
  const fs::path usual = find_ground_truth(places);
  if (usual.empty()) return std::nullopt;
  return FoundTruth{usual, {}, Pose()};
}

Trajectory read_truth(const FoundTruth& truth, const std::vector<Nanoseconds>& stamps,
                      RecordingInfo& info) {
  Trajectory poses = truth.boreas ? read_boreas(truth.file) : read_ground_truth(truth.file, stamps);
  for (StampedPose& pose : poses) pose.pose = pose.pose * truth.T_tracked_lidar;
  const std::string name = truth.file.filename().string();
  info.notes.push_back(truth.dataset.empty()
                           ? "Ground truth is " + name + ", taken to be of the LiDAR itself."
                           : "Ground truth is " + name + ", by the convention of " + truth.dataset +
                                 (truth.boreas
                                      ? ", of the LiDAR itself."
                                      : ", brought to the LiDAR with the data set's calibration."));
  return poses;
}

Trajectory truth_beside(const fs::path& recording, const std::vector<Nanoseconds>& stamps,
                        RecordingInfo& info) {
  const std::optional<FoundTruth> found = find_truth(recording);
  if (!found) return {};
  try {
    return read_truth(*found, stamps, info);
  } catch (const InputError& e) {
    info.warnings.push_back("No ground truth is taken: " + std::string(e.what()) + ".");
    return {};
  }
}

}  // namespace groundloop::recordings
