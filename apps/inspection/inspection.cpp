#include "apps/inspection/inspection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kSampled = 5;
constexpr std::size_t kGapsNamed = 5;

std::string text(const char* format, double a, double b = 0.0) {
  std::array<char, 96> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, a, b);
  return buffer.data();
}

// To a number of steps a unit, so that it prints in few digits.
double rounded(double value, double steps) { return std::round(value * steps) / steps; }

void add_range(std::vector<double>& values, const char* name, const char* unit,
               std::vector<ValueRange>& ranges) {
  if (values.empty()) return;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double median = *middle;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  ranges.push_back({name, unit, *least, median, *most});
}

std::vector<ValueRange> ranges_of(const std::vector<Scan>& scans) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::vector<double> range, elevation, time, intensity, reflectivity, ring, number;
  const auto append = [](const auto& from, std::vector<double>& to) {
    for (const auto value : from) to.push_back(static_cast<double>(value));
  };
  for (const Scan& scan : scans) {
    for (const Eigen::Vector3f& point : scan.points) {
      const Eigen::Vector3d p = point.cast<double>();
      range.push_back(p.norm());
      elevation.push_back(std::atan2(p.z(), std::hypot(p.x(), p.y())) * kDegrees);
    }
    append(scan.times, time);
    append(scan.attributes.intensity, intensity);
    append(scan.attributes.reflectivity, reflectivity);
    append(scan.attributes.ring, ring);
    append(scan.attributes.return_number, number);
  }
  std::vector<ValueRange> ranges;
  add_range(range, "range", "m", ranges);
  add_range(elevation, "elevation", "deg", ranges);
  add_range(time, "point_time", "s", ranges);
  add_range(intensity, "intensity", "", ranges);
  add_range(reflectivity, "reflectivity", "", ranges);
  add_range(ring, "ring", "", ranges);
  add_range(number, "return_number", "", ranges);
  return ranges;
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

class Lines {
 public:
  void add(const std::string& key, const std::string& value) {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%-14s ", key.c_str());
    text_ += name.data() + (value.empty() ? "-" : value) + "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string rhythm(const Inspection& i) {
  const ScanTiming& t = i.timing;
  if (i.scans < 2) return "one scan";
  std::string line = text("%.3g s, %.4g Hz", t.duration_s, t.rate_hz);
  if (i.info.stamp_source.starts_with("assumed")) return line + " (assumed)";
  return line +
         text("; intervals of %.1f ms, most within %.1f ms of it", 1e3 * t.period_s,
              1e3 * t.jitter_s) +
         text(", the longest %.3g s", t.longest_s);
}

std::string gaps_text(const ScanTiming& timing) {
  if (timing.gaps.empty()) return "none";
  std::string line = std::to_string(timing.gaps.size()) + ", in which " +
                     std::to_string(timing.missing) + " scans would fit:";
  for (std::size_t k = 0; k < std::min(kGapsNamed, timing.gaps.size()); ++k) {
    const TimeGap& gap = timing.gaps[k];
    line += (k == 0 ? " " : ", ") + text("%.3g s", gap.seconds) + " after scan " +
            std::to_string(gap.after);
  }
  if (timing.gaps.size() > kGapsNamed) line += ", ...";
  return line;
}

std::string value_line(const ValueRange& v) {
  return text("%.5g to %.5g", v.least, v.most) + (v.unit.empty() ? "" : " " + v.unit) +
         text(", median %.5g", v.median);
}

}  // namespace

Inspection inspect_recording(Recording& recording, const std::vector<std::string>& paths,
                             const RecordingOptions& options) {
  Inspection inspection;
  inspection.info = recording.info();
  inspection.scans = recording.size();
  inspection.first_stamp = recording.stamp(0);
  inspection.last_stamp = recording.stamp(recording.size() - 1);
  inspection.timing = measure_timing(recording);
  std::vector<Scan> scans;
  std::vector<std::size_t> indices;
  for (const std::size_t index : recordings::spread_indices(recording.size(), kSampled)) {
    try {
      scans.push_back(recording.read(index));
      indices.push_back(index);
    } catch (const InputError& e) {
      inspection.unreadable.emplace_back(e.what());
    }
  }
  if (scans.empty()) throw InputError(inspection.unreadable.front());
  inspection.sampled = scans.size();
  inspection.fewest_points = scans.front().points.size();
  for (const Scan& scan : scans) {
    inspection.fewest_points = std::min(inspection.fewest_points, scan.points.size());
    inspection.most_points = std::max(inspection.most_points, scan.points.size());
  }
  inspection.sensor = recordings::recognise_sensor(scans);
  inspection.values = ranges_of(scans);
  const Trajectory truth = recording.ground_truth();
  inspection.truth_poses = truth.size();
  inspection.truth_path_m = path_length(truth);
  inspection.proposed = propose_run(paths, options, recording);
  inspection.example_index = indices[scans.size() / 2];
  inspection.example = std::move(scans[scans.size() / 2]);
  return inspection;
}

Json to_json(const Inspection& i) {
  const RecordingInfo& info = i.info;
  Json json;
  json["path"] = info.path;
  json["format"] = info.format;
  json["sensor"] = info.sensor;
  json["points_look_like"] = {{"text", i.sensor.described()},
                              {"models", i.sensor.models},
                              {"evidence", i.sensor.evidence},
                              {"rings", i.sensor.rings},
                              {"lowest_deg", rounded(i.sensor.lowest_deg, 1e2)},
                              {"highest_deg", rounded(i.sensor.highest_deg, 1e2)},
                              {"turn_deg", i.sensor.turn_deg}};
  json["scans"] = i.scans;
  json["rate_hz"] = rounded(i.timing.rate_hz, 1e3);
  json["first_stamp"] = seconds_text(i.first_stamp);
  json["last_stamp"] = seconds_text(i.last_stamp);
  json["duration_s"] = rounded(i.timing.duration_s, 1e9);
  json["stamps"] = info.stamp_source;
  Json gaps = Json::array();
  for (const TimeGap& gap : i.timing.gaps)
    gaps.push_back(
        {{"after_scan", gap.after}, {"s", rounded(gap.seconds, 1e6)}, {"missing", gap.missing}});
  json["timing"] = {{"period_s", rounded(i.timing.period_s, 1e9)},
                    {"jitter_s", rounded(i.timing.jitter_s, 1e6)},
                    {"longest_s", rounded(i.timing.longest_s, 1e6)},
                    {"missing_scans", i.timing.missing},
                    {"gaps", gaps}};
  json["fields"] = info.fields;
  json["point_times"] = info.point_times;
  json["gaps"] = info.gaps;
  json["duplicates"] = info.duplicates;
  json["out_of_order"] = info.out_of_order;
  json["dropped_scans"] = info.dropped_scans;
  json["ground_truth_poses"] = i.truth_poses;
  json["path_length_m"] = rounded(i.truth_path_m, 1e2);
  json["sampled"] = {
      {"scans", i.sampled}, {"points_min", i.fewest_points}, {"points_max", i.most_points}};
  for (const ValueRange& v : i.values) {
    const std::string unit = v.unit.empty() ? "" : "_" + v.unit;
    json["sampled"][v.name + "_min" + unit] = rounded(v.least, 1e6);
    json["sampled"][v.name + "_median" + unit] = rounded(v.median, 1e6);
    json["sampled"][v.name + "_max" + unit] = rounded(v.most, 1e6);
  }
  json["unreadable"] = i.unreadable;
  json["warnings"] = info.warnings;
  json["notes"] = info.notes;
  json["proposed"] = {{"command", i.proposed.command}, {"to_add", i.proposed.to_add}};
  return json;
}

std::string to_text(const Inspection& i) {
  const RecordingInfo& info = i.info;
  Lines lines;
  lines.add("recording", info.path);
  lines.add("format", info.format);
  lines.add("sensor", info.sensor.empty() ? "not stated" : info.sensor);
  lines.add("points show", i.sensor.described());
  lines.add("scans", std::to_string(i.scans) + ", " + rhythm(i));
  lines.add("gaps", gaps_text(i.timing));
  lines.add("stamps", info.stamp_source + ", from " + seconds_text(i.first_stamp) + " to " +
                          seconds_text(i.last_stamp) + " s");
  lines.add("point times", info.point_times);
  lines.add("fields", joined(info.fields));
  lines.add("points", std::to_string(i.fewest_points) + " to " + std::to_string(i.most_points) +
                          " a scan, in " + std::to_string(i.sampled) + " scans looked at");
  for (const ValueRange& v : i.values) lines.add("  " + v.name, value_line(v));
  lines.add("ground truth", i.truth_poses == 0 ? "none beside it that is taken by itself"
                                               : std::to_string(i.truth_poses) + " poses, " +
                                                     text("%.1f m", i.truth_path_m));
  const auto counted = [&](std::size_t n, const char* what) {
    if (n > 0) lines.add("counted", std::to_string(n) + " " + what);
  };
  counted(info.out_of_order, "scans out of order, put in order");
  counted(info.duplicates, "scans there twice, of which one is used");
  counted(info.dropped_scans, "scans not used");
  for (const std::string& note : info.notes) lines.add("note", note);
  for (const std::string& warning : info.warnings) lines.add("warning", warning);
  for (const std::string& why : i.unreadable) lines.add("unreadable", why);
  lines.add("to run it", i.proposed.command);
  for (const std::string& more : i.proposed.to_add) lines.add("would help", more);
  return lines.text();
}

}  // namespace groundloop::apps
