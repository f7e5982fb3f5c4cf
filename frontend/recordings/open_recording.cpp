// Which reader a path is for, and what is wrapped around it: elevation correction, range of scans.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "frontend/core/error.hpp"
#include "frontend/recordings/bags.hpp"
#include "frontend/recordings/datasets.hpp"
#include "frontend/recordings/elevation_correction.hpp"
#include "frontend/recordings/folder.hpp"
#include "frontend/recordings/kitti.hpp"
#include "frontend/recordings/no_recording.hpp"
#include "frontend/recordings/packets/packet_recording.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/recordings/wrappers.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

using Options = RecordingOptions;

struct Format {
  const char* name;
  const char* looked_for;               ///< what a path must hold, for messages
  bool (*recognises)(const fs::path&);  ///< of a path that exists
  std::unique_ptr<Recording> (*open)(const fs::path&, const Options&);
  bool takes_several = false;  ///< reads options.more_paths
};

bool is_kitti(const fs::path& path) { return !recordings::find_kitti_sequence(path).empty(); }

std::unique_ptr<Recording> open_kitti(const fs::path& path, const Options& options) {
  return recordings::open_kitti(recordings::find_kitti_sequence(path), options);
}

// In order of recognition: the more particular first.
const std::array kFormats = {
    Format{"kitti", "a KITTI sequence (velodyne/*.bin or sequences/NN/velodyne/*.bin)", is_kitti,
           open_kitti},
    Format{"kitti_raw", "a KITTI raw drive (velodyne_points/data/*.bin)", recordings::is_kitti_raw,
           recordings::open_kitti_raw},
    Format{"helipr", "HeLiPR (LiDAR/SENSOR/*.bin)", recordings::is_helipr, recordings::open_helipr},
    Format{"mulran", "MulRan (sensor_data/Ouster/*.bin)", recordings::is_mulran,
           recordings::open_mulran},
    Format{"nclt", "NCLT (velodyne_sync/*.bin or velodyne_hits.bin)", recordings::is_nclt,
           recordings::open_nclt},
    Format{"nuscenes", "nuScenes (v1.0-*/sample_data.json)", recordings::is_nuscenes,
           recordings::open_nuscenes},
    Format{"rosbag", "ROS 1 bags (*.bag)", recordings::is_rosbag, recordings::open_rosbag, true},
    Format{"rosbag2", "a ROS 2 bag (metadata.yaml, *.db3)", recordings::is_rosbag2,
           recordings::open_rosbag2, true},
    Format{"mcap", "MCAP files (*.mcap)", recordings::is_mcap, recordings::open_mcap, true},
    Format{"pcap", "a capture of packets (*.pcap)", recordings::is_pcap, recordings::open_pcap},
    Format{"folder", "scans in *.bin, *.pcd or *.ply files", recordings::is_scan_folder,
           recordings::open_folder},
};

// recognises() where several sequences are no error.
bool is_here(const Format& format, const fs::path& path) {
  try {
    return format.recognises(path);
  } catch (const InputError&) {
    return true;
  }
}

std::string names_of_formats() {
  std::string names;
  for (const Format& format : kFormats)
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

const Format& choose_format(const fs::path& path, const std::string& name) {
  std::string looked_for;
  for (const Format& format : kFormats) {
    if (name == format.name) {
      if (format.recognises(path)) return format;
      throw InputError(path.string() + ": holds nothing of format " + name + "; looked for " +
                       format.looked_for);
    }
    if (name.empty() && format.recognises(path)) return format;
    looked_for += (looked_for.empty() ? "" : ", ") + std::string(format.looked_for);
  }
  if (!name.empty()) {
    throw InputError("--format " + name + " is unknown; known are " + names_of_formats());
  }
  throw InputError(recordings::not_recognised(path, looked_for, [](const fs::path& folder) {
    return std::any_of(kFormats.begin(), kFormats.end(),
                       [&](const Format& format) { return is_here(format, folder); });
  }));
}

// What a folder holds beside what is read of it.
std::string others_beside(const fs::path& path, const Format& chosen) {
  std::error_code error;
  std::string others;
  if (!fs::is_directory(path, error)) return others;
  for (const Format& format : kFormats) {
    // A ROS 2 bag is of files that are recordings themselves.
    const bool part =
        std::string_view(chosen.name) == "rosbag2" && std::string_view(format.name) == "mcap";
    if (&format == &chosen || part || !is_here(format, path)) continue;
    others += (others.empty() ? "" : "; ") + std::string(format.looked_for) + ", by --format " +
              format.name;
  }
  return others;
}

// What the scans show, or nothing where they cannot be read: then the run says so.
std::optional<recordings::SensorSignature> signature_of(Recording& recording) {
  try {
    return recordings::sensor_signature(recording);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// KITTI's elevation error is a fact of its scans, whatever they are kept in. Its own layouts are
// evidence enough; elsewhere the same sensor may have been used by others, and the user decides.
std::unique_ptr<Recording> correct(std::unique_ptr<Recording> recording, const Options& options) {
  const std::string& choice = options.elevation_correction;
  if (choice == "on")
    return recordings::with_elevation_correction(std::move(recording), "by option");
  if (choice == "off") {
    return recordings::with_note(std::move(recording), "Elevation is not corrected (by option).");
  }
  if (choice != "auto") {
    throw InputError("elevation_correction: '" + choice +
                     "' is unknown; allowed are auto, on, off");
  }
  if (options.dataset == "kitti")
    return recordings::with_elevation_correction(std::move(recording), "--dataset kitti");
  if (!options.dataset.empty()) return recording;
  const std::string format = recording->info().format;
  const bool timed = recording->info().point_times != "none";
  if (format == "folder" && !timed) {
    const auto signature = signature_of(*recording);
    if (!signature || !signature->kitti_hdl64) return recording;
    return recordings::with_note(
        std::move(recording),
        "The scans are like those of KITTI's HDL-64E (" + signature->reason +
            "), whose elevations are 0.205 degrees too low: add --dataset kitti if they are.");
  }
  if (format != "kitti" && format != "kitti_raw") return recording;
  if (format == "kitti" && timed) {
    return recordings::with_note(
        std::move(recording),
        "Elevation is not corrected: scans with per-point times are not KITTI's own, which come "
        "deskewed.");
  }
  const recordings::SensorSignature signature = recordings::sensor_signature(*recording);
  if (signature.kitti_hdl64) {
    return recordings::with_elevation_correction(std::move(recording),
                                                 "KITTI's HDL-64E: " + signature.reason);
  }
  return recordings::with_note(
      std::move(recording),
      "Elevation is not corrected: " + signature.reason + ", not those of KITTI's HDL-64E.");
}

// What a data set's name stands for beside its layout.
Options with_dataset(Options options) {
  if (options.dataset == "nuscenes" && options.fields.empty())
    options.fields = "x,y,z,intensity,ring";
  for (const char* known : {"", "none", "kitti", "nuscenes"}) {
    if (options.dataset == known) return options;
  }
  throw InputError("--dataset: '" + options.dataset +
                   "' is unknown; known are kitti, nuscenes, none");
}

std::unique_ptr<Recording> open_path(const std::string& path, const RecordingOptions& options) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    throw InputError(path + ": no such file or folder; check the path");
  }
  if (options.format.empty()) recordings::refuse_what_is_no_recording(path);
  const Format& format = choose_format(path, options.format);
  if (!options.more_paths.empty() && !format.takes_several) {
    throw InputError(options.more_paths.front() + ": a recording of format " + format.name +
                     " is one path; only bags may be several");
  }
  std::unique_ptr<Recording> recording = format.open(path, options);
  const std::string others = others_beside(path, format);
  if (others.empty() || !options.format.empty()) return recording;
  return recordings::with_note(std::move(recording), "The folder also holds " + others + ".");
}

}  // namespace

std::unique_ptr<Recording> recordings::wrap(std::unique_ptr<Recording> recording,
                                            const RecordingOptions& options) {
  recording = correct(std::move(recording), options);
  if (!options.stamp.empty())
    recording = recordings::with_stamp_at(std::move(recording), options.stamp);
  if (options.first == 0 && options.count >= recording->size()) return recording;
  return slice(std::move(recording), options.first, options.count);
}

std::unique_ptr<Recording> open_recording(const std::string& path,
                                          const RecordingOptions& options) {
  const Options chosen = with_dataset(options);
  return recordings::wrap(open_path(path, chosen), chosen);
}

}  // namespace groundloop
