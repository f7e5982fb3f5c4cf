#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/commands/commands.hpp"
#include "apps/commands/reading_options.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/recordings/sensor_recognition.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  std::vector<std::string> paths;
  RecordingOptions options;
  bool json = false;
};

/// What a few scans, spread over the recording, tell of its points.
struct Sample {
  std::size_t scans = 0;
  std::size_t fewest = 0, most = 0;
  double nearest = 0.0, farthest = 0.0;
  double lowest_deg = 90.0, highest_deg = -90.0;
  double first_time = 0.0, last_time = 0.0;
  bool timed = false;
  std::string sensor;  ///< as its points tell
};

Sample sample_scans(Recording& recording) {
  constexpr std::size_t kScans = 5;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  Sample sample;
  std::set<std::size_t> indices;
  for (std::size_t k = 0; k < kScans; ++k) {
    indices.insert(k * (recording.size() - 1) / (kScans - 1));
  }
  std::vector<Scan> scans;
  for (const std::size_t index : indices) {
    scans.push_back(recording.read(index));
    const Scan& scan = scans.back();
    const bool first = sample.scans++ == 0;
    sample.fewest = first ? scan.points.size() : std::min(sample.fewest, scan.points.size());
    sample.most = std::max(sample.most, scan.points.size());
    for (const Eigen::Vector3f& point : scan.points) {
      const Eigen::Vector3d p = point.cast<double>();
      const double range = p.norm();
      const double elevation = std::asin(p.z() / range) * kDegrees;
      sample.nearest = sample.farthest == 0.0 ? range : std::min(sample.nearest, range);
      sample.farthest = std::max(sample.farthest, range);
      sample.lowest_deg = std::min(sample.lowest_deg, elevation);
      sample.highest_deg = std::max(sample.highest_deg, elevation);
    }
    for (const float time : scan.times) {
      const auto t = static_cast<double>(time);
      sample.first_time = sample.timed ? std::min(sample.first_time, t) : t;
      sample.last_time = sample.timed ? std::max(sample.last_time, t) : t;
      sample.timed = true;
    }
  }
  sample.sensor = recordings::recognise_sensor(scans);
  return sample;
}

double scan_rate(const Recording& recording) {
  if (recording.size() < 2) return 0.0;
  std::vector<Nanoseconds> steps;
  for (std::size_t i = 1; i < recording.size(); ++i) {
    steps.push_back(recording.stamp(i) - recording.stamp(i - 1));
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle > 0 ? 1e9 / static_cast<double>(*middle) : 0.0;
}

// To a number of steps a unit, so that it prints in few digits.
double rounded(double value, double steps) { return std::round(value * steps) / steps; }

nlohmann::ordered_json describe(Recording& recording) {
  const RecordingInfo& info = recording.info();
  const Sample sample = sample_scans(recording);
  const Trajectory truth = recording.ground_truth();
  nlohmann::ordered_json json;
  json["path"] = info.path;
  json["format"] = info.format;
  json["sensor"] = info.sensor;
  json["points_look_like"] = sample.sensor;
  json["scans"] = recording.size();
  json["rate_hz"] = rounded(scan_rate(recording), 1e3);
  json["first_stamp"] = seconds_text(recording.stamp(0));
  json["last_stamp"] = seconds_text(recording.stamp(recording.size() - 1));
  json["duration_s"] =
      1e-9 * static_cast<double>(recording.stamp(recording.size() - 1) - recording.stamp(0));
  json["stamps"] = info.stamp_source;
  json["fields"] = info.fields;
  json["point_times"] = info.point_times;
  json["gaps"] = info.gaps;
  json["duplicates"] = info.duplicates;
  json["out_of_order"] = info.out_of_order;
  json["dropped_scans"] = info.dropped_scans;
  json["ground_truth_poses"] = truth.size();
  json["path_length_m"] = rounded(path_length(truth), 1e2);
  json["sampled"] = {{"scans", sample.scans},
                     {"points_min", sample.fewest},
                     {"points_max", sample.most},
                     {"range_min_m", rounded(sample.nearest, 1e3)},
                     {"range_max_m", rounded(sample.farthest, 1e3)},
                     {"elevation_min_deg", rounded(sample.lowest_deg, 1e2)},
                     {"elevation_max_deg", rounded(sample.highest_deg, 1e2)}};
  if (sample.timed) {
    json["sampled"]["point_time_min_s"] = rounded(sample.first_time, 1e6);
    json["sampled"]["point_time_max_s"] = rounded(sample.last_time, 1e6);
  }
  json["notes"] = info.notes;
  return json;
}

std::string value_text(const nlohmann::ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return to_text(value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const auto& element : value) text += (text.empty() ? "" : ", ") + value_text(element);
  return text;
}

void print_table(const nlohmann::ordered_json& json) {
  const auto line = [](const std::string& key, const std::string& value) {
    std::printf("%-20s %s\n", key.c_str(), value.empty() ? "-" : value.c_str());
  };
  for (const auto& [key, value] : json.items()) {
    if (key == "notes") {
      for (const auto& note : value) line("note", value_text(note));
    } else if (value.is_object()) {
      for (const auto& [inner, number] : value.items()) line("  " + inner, value_text(number));
    } else {
      line(key, value_text(value));
    }
  }
}

void run(const Arguments& arguments) {
  RecordingOptions options = arguments.options;
  options.attributes.ring = true;
  options.more_paths.assign(arguments.paths.begin() + 1, arguments.paths.end());
  const std::unique_ptr<Recording> recording = open_any_recording(arguments.paths.front(), options);
  const nlohmann::ordered_json json = describe(*recording);
  if (arguments.json) {
    std::printf("%s\n", json.dump(2).c_str());
  } else {
    print_table(json);
  }
}

}  // namespace

void add_inspect_command(CLI::App& app, Context&) {
  CLI::App* command =
      app.add_subcommand("inspect", "what a recording holds: format, stamps, fields, point times");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("RECORDING", arguments->paths,
                   "path of a recording, or of several bags of one, or sim:WORLD?key=value&...")
      ->required();
  add_reading_options(*command, arguments->options);
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace groundloop::apps
