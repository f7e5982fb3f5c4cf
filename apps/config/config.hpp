// The whole configuration as sections of options, read from YAML and from --set, written back with
// units and reasons. Keys are `section.key`; an unknown one is an error that names the nearest
// known one.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "backend/mapping/slam.hpp"
#include "backend/merging/session_merge.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

struct RecordingSection {
  std::string elevation_correction = "auto";

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("elevation_correction", self.elevation_correction, Choices{"auto", "on", "off"}, "",
          "raises points by the 0.205 degrees that KITTI's scans lack; auto: only where the scans "
          "are of that sensor");
  }
};

struct MapSection {
  bool write = true;
  double voxel_size = 0.2;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("write", self.write, OnOff{}, "", "write map.pcd at the end of a run");
    field("voxel_size", self.voxel_size, Range{0.0, 100.0}, "m",
          "of map.pcd: one point a voxel, the mean; 0 keeps every point of the local maps");
  }
};

struct ReportSection {
  int points = 1'000'000;
  int closures = 60;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("points", self.points, Range{0, 10'000'000}, "",
          "of the 3-D view in report.html, thinned evenly; a million take some 7 MB, 0 leaves the "
          "view out");
    field("closures", self.closures, Range{0, 100'000}, "",
          "shown with their images and cross-sections, accepted ones first; each takes some 60 kB");
  }
};

struct Config {
  RecordingSection recording;
  SlamOptions slam;
  MapSection map;
  ReportSection report;
  ConnectionOptions connection;
};

/// Calls f(name, options) for every section.
template <typename Self, typename F>
void for_each_section(Self& config, F&& f) {
  f("recording", config.recording);
  f("keeping", config.slam.keeping);
  f("kept_scans", config.slam.kept_scans);
  f("odometry", config.slam.odometry);
  f("local_maps", config.slam.local_maps);
  f("ground_alignment", config.slam.loop_closure.ground_alignment);
  f("density_image", config.slam.loop_closure.density_image);
  f("features", config.slam.loop_closure.features);
  f("matching", config.slam.loop_closure.matching);
  f("consensus", config.slam.loop_closure.consensus);
  f("closures", config.slam.closures);
  f("registration", config.slam.registration);
  f("verification", config.slam.verification);
  f("levelling", config.slam.levelling);
  f("odometry_information", config.slam.odometry_information);
  f("pose_graph", config.slam.pose_graph);
  f("revisits", config.slam.revisits);
  f("map_quality", config.slam.map_quality);
  f("map", config.map);
  f("report", config.report);
  f("connection", config.connection);
}

/// Sets `section.key` from text. `place` stands before the error ("--set", "file.yaml:12").
void set_option(Config& config, const std::string& key, const std::string& value,
                const std::string& place);

/// Reads a YAML file, or a preset by its name, over `config`.
void read_config(Config& config, const std::string& file_or_preset);

/// The defaults, a file or preset over them unless empty, and settings KEY=VALUE over those.
[[nodiscard]] Config effective_config(const std::string& file_or_preset,
                                      const std::vector<std::string>& settings);

/// Throws InputError naming the first value that is out of its range.
void validate_config(const Config& config);

/// One option as text.
struct ConfigEntry {
  std::string section, key, value;
  std::string allowed;  ///< "0 to 1", "auto | on | off"; empty for a switch
  std::string unit, reason;
};
/// Every option, in the order of the sections.
[[nodiscard]] std::vector<ConfigEntry> list_config(const Config& config);

/// The whole configuration as YAML, with the unit and the reason of every key.
[[nodiscard]] std::string to_yaml(const Config& config);

/// Names of the presets that are built in.
[[nodiscard]] std::vector<std::string> preset_names();

}  // namespace groundloop::apps
