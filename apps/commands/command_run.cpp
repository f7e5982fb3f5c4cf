#include <memory>

#include "apps/commands/commands.hpp"
#include "apps/commands/reading_options.hpp"
#include "apps/commands/run.hpp"
#include "apps/commands/validators.hpp"

namespace groundloop::apps {
namespace {

struct RunArguments {
  RunRequest request;
  std::vector<std::string> recordings;
  std::string config_file;
  std::vector<std::string> settings;
};

void add_config_options(CLI::App& command, RunArguments& arguments) {
  command.add_option("--config", arguments.config_file, "YAML file or preset");
  command
      .add_option("--set", arguments.settings,
                  "KEY=VALUE, e.g. odometry.voxel_size=0.5; may be repeated")
      ->take_all();
}

}  // namespace

void add_run_command(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("run", "odometry, loop closing, optimisation and map of one recording");
  auto arguments = std::make_shared<RunArguments>();
  RunRequest& request = arguments->request;
  command
      ->add_option("RECORDING", arguments->recordings,
                   "path, several bags of one recording, or sim:WORLD?key=value&...")
      ->required();
  command->add_option("--out", request.out, "folder of the session")->required();
  add_reading_options(*command, request.reading);
  command->add_option("--ground-truth", request.ground_truth,
                      "trajectory to compare with: TUM or KITTI");
  command->add_option("--truth-frame", request.truth_frame,
                      "what the poses of the ground truth are of: sensor, camera (by calib.txt), "
                      "or a file with T_truth_sensor as a 4x4 matrix");
  command->add_option("--first", request.reading.first, "number of the first scan to use, from 0")
      ->check(whole_number());
  command->add_option("--count", request.reading.count, "number of scans to use")
      ->check(whole_number());
  command->add_flag("--resume", request.resume, "go on with the unfinished session in the folder");
  command->add_flag("--overwrite", request.overwrite,
                    "replace the session in the folder, once the new one is complete");
  add_config_options(*command, *arguments);
  command->callback([arguments, &context] {
    RunRequest& run = arguments->request;
    run.recording = arguments->recordings.front();
    run.reading.more_paths.assign(arguments->recordings.begin() + 1, arguments->recordings.end());
    arguments->request.config = effective_config(arguments->config_file, arguments->settings);
    run_recording(arguments->request, context);
  });
}

void add_demo_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "demo", "a drive through a simulated town: drift before, closed loops after");
  auto arguments = std::make_shared<RunArguments>();
  arguments->request.recording = "sim:town?sensor=spin64&carrier=car&length=1000&seed=1";
  arguments->request.out = "groundloop_demo";
  command->add_option("--out", arguments->request.out, "folder of the session (groundloop_demo)");
  command->add_flag("--overwrite", arguments->request.overwrite,
                    "replace the session in the folder, once the new one is complete");
  add_config_options(*command, *arguments);
  command->callback([arguments, &context] {
    arguments->request.config = effective_config(arguments->config_file, arguments->settings);
    run_recording(arguments->request, context);
  });
}

}  // namespace groundloop::apps
