#include "apps/commands/reading_options.hpp"

namespace groundloop::apps {

void add_reading_options(CLI::App& command, RecordingOptions& options) {
  command.add_option("--format", options.format, "format, where it is not recognised");
  command.add_option(
      "--topic", options.topic,
      "topic, sensor (of a capture: sender, port or both) or scene, where there are several");
  command.add_option("--fields", options.fields,
                     "values of a record of headerless files, where they are judged wrongly, e.g. "
                     "x,y,z,intensity,ring,t");
  command
      .add_option("--dataset", options.dataset,
                  "data set whose facts apply, where the layout is not its own: kitti, nuscenes; "
                  "none: no facts are applied")
      ->check(CLI::IsMember({"kitti", "nuscenes", "none"}));
  command.add_option("--calibration", options.calibration,
                     "calibration of the sensor whose packets were recorded: Velodyne YAML, Hesai "
                     "CSV, Ouster JSON");
  command
      .add_option("--time-unit", options.time_unit,
                  "unit of per-point times, where it is judged wrongly: ns, us, ms or s")
      ->check(CLI::IsMember({"ns", "us", "ms", "s"}));
  command
      .add_option("--stamp", options.stamp,
                  "instant of a scan that its stamp names: start, middle or end")
      ->check(CLI::IsMember({"start", "middle", "end"}));
}

}  // namespace groundloop::apps
