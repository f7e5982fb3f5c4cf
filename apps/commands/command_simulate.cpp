#include <cstdio>
#include <memory>
#include <string>

#include <spdlog/spdlog.h>

#include "apps/commands/commands.hpp"
#include "apps/commands/validators.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  std::string recording;
  std::string layout;
  std::string folder;
  std::string sensor;
  RecordingOptions options;
};

// HeLiPR's LiDAR that is most like the simulated one.
std::string helipr_sensor(const std::string& recording) {
  if (recording.find("sensor=raster") != std::string::npos) return "Aeva";
  if (recording.find("sensor=rosette") != std::string::npos) return "Avia";
  if (recording.find("sensor=spin16") != std::string::npos) return "Velodyne";
  return "Ouster";
}

void run(const Arguments& arguments) {
  const std::unique_ptr<Recording> recording =
      open_any_recording(arguments.recording, arguments.options);
  const std::string sensor =
      arguments.sensor.empty() ? helipr_sensor(arguments.recording) : arguments.sensor;
  write_layout(*recording, arguments.layout, arguments.folder, sensor);
  spdlog::info("{} scans written to {} in the layout {}", recording->size(), arguments.folder,
               arguments.layout);
}

}  // namespace

void add_simulate_command(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand(
      "simulate", "write a simulated recording (or any other) in a recording's layout");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("SIM", arguments->recording,
                   "sim:WORLD?key=value&..., or the path of a recording")
      ->required();
  command
      ->add_option("--layout", arguments->layout,
                   "kitti, mulran, helipr, nclt, rosbag, rosbag2, mcap or folder")
      ->required()
      ->check(CLI::IsMember(layout_names()));
  command->add_option("--out", arguments->folder, "folder to write, new or empty")->required();
  command
      ->add_option("--sensor", arguments->sensor,
                   "record of helipr: Ouster, Velodyne, Avia or Aeva (default: the one most like "
                   "the simulated sensor)")
      ->check(CLI::IsMember({"Ouster", "Velodyne", "Avia", "Aeva"}));
  command->add_option("--first", arguments->options.first, "first scan to write")
      ->check(whole_number());
  command->add_option("--count", arguments->options.count, "scans to write at most")
      ->check(whole_number());
  command->callback([arguments] { run(*arguments); });
}

}  // namespace groundloop::apps
