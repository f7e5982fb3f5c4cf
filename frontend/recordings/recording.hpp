// A recording: scans in time order, whatever the format on disk, and the ground truth that came
// with it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "frontend/core/scan.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop {

/// What was found in a recording; printed by `inspect` and kept in the manifest.
struct RecordingInfo {
  std::string path;
  std::string format;        ///< e.g. "kitti", "folder", "sim"
  std::string sensor;        ///< what is known of the LiDAR, e.g. "64 beams, +2.0 to -24.8 degrees"
  std::string point_times;   ///< where per-point times come from and in which unit, or "none"
  std::string stamp_source;  ///< e.g. "times.txt", "file names (ns)", "assumed 10 Hz"
  std::vector<std::string> fields;  ///< fields of a point record
  AttributeSet attributes;          ///< that its points have
  std::vector<std::string> notes;   ///< corrections applied, assumptions made, one sentence each
  /// What is wrong with the recording, and what was done about it, one sentence each: a file cut
  /// off, packets lost, a clock set back. What the counts below say is not said again.
  std::vector<std::string> warnings;
  /// Where only a range of the scans is used: the number of the first, and how many there are.
  std::size_t first_scan = 0, scans_in_all = 0;
  /// Scans that were seen but set aside or put right, counted by the source.
  std::size_t out_of_order = 0, duplicates = 0, gaps = 0, dropped_scans = 0;
};

/// Choices a user can make about how a recording is read.
struct RecordingOptions {
  std::string format;  ///< empty: recognised
  std::string topic;   ///< of a bag with several point-cloud topics, or sensor of a dataset
  /// Further bags of the same recording, read together in time order.
  std::vector<std::string> more_paths;
  std::size_t first = 0;
  std::size_t count = static_cast<std::size_t>(-1);
  /// Attributes of points to be read into Scan::attributes, as far as the recording has them.
  AttributeSet attributes;
  /// Unit of per-point times: "ns", "us", "ms", "s"; empty: judged by what the times are.
  std::string time_unit;
  /// Which instant of a scan its stamp names: "start", "middle", "end"; empty: as the times of its
  /// points say, else the start.
  std::string stamp;
  /// Values of a headerless record, e.g. "x,y,z,intensity,ring,t"; empty: told by their values.
  std::string fields;
  /// Data set whose facts apply: "kitti", "nuscenes", ..., "none"; empty: told by the scans.
  std::string dataset;
  /// Calibration of a sensor whose packets were recorded; empty: its model's nominal table.
  std::string calibration;
  /// "auto" corrects KITTI's elevation error where the scans are of that sensor, "on" always, "off"
  /// never.
  std::string elevation_correction = "auto";
};

/// Scans are read one at a time from one thread; a Recording keeps no scan in memory.
class Recording {
 public:
  virtual ~Recording() = default;
  [[nodiscard]] virtual const RecordingInfo& info() const = 0;
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// The stamp of scan `index` without reading its points.
  [[nodiscard]] virtual Nanoseconds stamp(std::size_t index) const = 0;
  /// Scan `index` in [0, size()). Throws InputError naming file and place where it cannot be read.
  [[nodiscard]] virtual Scan read(std::size_t index) = 0;
  /// T_world_scan in a world of the recording's choice at the scans' stamps, one a scan or at a
  /// rate of its own; empty where there is none.
  [[nodiscard]] virtual Trajectory ground_truth() const { return {}; }
};

/// Opens a path, recognising the format unless it is given.
/// Throws InputError where nothing known is found, naming what was looked for.
[[nodiscard]] std::unique_ptr<Recording> open_recording(const std::string& path,
                                                        const RecordingOptions& options = {});

}  // namespace groundloop
