// Which reader a path is for, and what is wrapped around it: elevation correction, range of scans.
#include <algorithm>
#include <filesystem>

#include "frontend/core/error.hpp"
#include "frontend/recording.hpp"
#include "frontend/simulation/simulation.hpp"
#include "frontend/sources/elevation_correction.hpp"
#include "frontend/sources/kitti.hpp"
#include "frontend/sources/wrappers.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

std::string recognise(const fs::path& path) {
  if (!sources::find_kitti_sequence(path).empty()) return "kitti";
  return "";
}

std::unique_ptr<Recording> open_as(const std::string& format, const fs::path& path) {
  if (format == "kitti") {
    const fs::path sequence = sources::find_kitti_sequence(path);
    if (sequence.empty()) {
      throw InputError(path.string() +
                       ": no KITTI sequence here; looked for velodyne/*.bin and "
                       "sequences/NN/velodyne/*.bin");
    }
    return sources::open_kitti(sequence);
  }
  throw InputError("--format " + format + " is unknown; known are kitti");
}

std::unique_ptr<Recording> correct(std::unique_ptr<Recording> recording,
                                   const std::string& choice) {
  if (choice == "on") return sources::with_elevation_correction(std::move(recording), "by option");
  if (choice == "off") {
    return sources::with_note(std::move(recording), "Elevation is not corrected (by option).");
  }
  if (choice != "auto") {
    throw InputError("elevation_correction: '" + choice +
                     "' is unknown; allowed are auto, on, off");
  }
  const std::string format = recording->info().format;
  if (format != "kitti" && format != "kitti_raw") return recording;
  if (format == "kitti" && recording->info().point_times != "none") {
    return sources::with_note(
        std::move(recording),
        "Elevation is not corrected: scans with per-point times are not KITTI's own, which come "
        "deskewed.");
  }
  const sources::SensorSignature signature = sources::sensor_signature(*recording);
  if (signature.kitti_hdl64) {
    return sources::with_elevation_correction(std::move(recording),
                                              "KITTI's HDL-64E: " + signature.reason);
  }
  return sources::with_note(
      std::move(recording),
      "Elevation is not corrected: " + signature.reason + ", not those of KITTI's HDL-64E.");
}

}  // namespace

std::unique_ptr<Recording> open_recording(const std::string& path,
                                          const RecordingOptions& options) {
  if (is_simulation(path)) {
    std::unique_ptr<Recording> simulation = open_simulation(path);
    if (options.first == 0 && options.count >= simulation->size()) return simulation;
    return sources::slice(std::move(simulation), options.first, options.count);
  }
  std::error_code error;
  if (!fs::exists(path, error)) {
    throw InputError(path + ": no such file or folder; check the path");
  }
  const std::string format = options.format.empty() ? recognise(path) : options.format;
  if (format.empty()) {
    throw InputError(path +
                     ": no recording is recognised here; looked for a KITTI sequence "
                     "(velodyne/*.bin); name the format with --format");
  }
  std::unique_ptr<Recording> recording =
      correct(open_as(format, path), options.elevation_correction);
  if (options.first == 0 && options.count >= recording->size()) return recording;
  return sources::slice(std::move(recording), options.first, options.count);
}

}  // namespace groundloop
