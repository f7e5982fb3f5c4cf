// What a recording is, as `groundloop inspect` tells it: gathered once, for people and as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/inspection/proposed_run.hpp"
#include "apps/inspection/scan_timing.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/recordings/sensor_recognition.hpp"

namespace groundloop::apps {

/// Values of one quantity over the sampled points.
struct ValueRange {
  std::string name, unit;
  double least = 0.0, median = 0.0, most = 0.0;
};

struct Inspection {
  RecordingInfo info;
  std::size_t scans = 0;
  Nanoseconds first_stamp = 0, last_stamp = 0;
  ScanTiming timing;
  recordings::SensorEvidence sensor;
  std::size_t sampled = 0, fewest_points = 0, most_points = 0;
  std::vector<ValueRange> values;       ///< range, elevation, point_time and the attributes
  std::vector<std::string> unreadable;  ///< why scans of the sample could not be read
  std::size_t truth_poses = 0;
  double truth_path_m = 0.0;
  Scan example;  ///< from the middle; drawn
  std::size_t example_index = 0;
  ProposedRun proposed;
};

/// Reads up to five scans, spread over the recording. Throws InputError where none can be read.
[[nodiscard]] Inspection inspect_recording(Recording& recording,
                                           const std::vector<std::string>& paths,
                                           const RecordingOptions& options);

[[nodiscard]] nlohmann::ordered_json to_json(const Inspection& inspection);
/// Lines for people, the sketch aside.
[[nodiscard]] std::string to_text(const Inspection& inspection);

}  // namespace groundloop::apps
