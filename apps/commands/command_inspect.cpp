// `groundloop inspect RECORDING`: what it is, whether it can be trusted, and how to run it.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include "apps/commands/commands.hpp"
#include "apps/commands/reading_options.hpp"
#include "apps/inspection/inspection.hpp"
#include "apps/inspection/inspection_picture.hpp"
#include "apps/inspection/terminal_sketch.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop::apps {
namespace {

struct Arguments {
  std::vector<std::string> paths;
  RecordingOptions options;
  std::string png;
  bool json = false;
  bool sketch = false;
};

std::vector<double> intervals_of(const Recording& recording) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < recording.size(); ++i)
    intervals.push_back(1e-9 * static_cast<double>(recording.stamp(i) - recording.stamp(i - 1)));
  return intervals;
}

void run(const Arguments& arguments) {
  RecordingOptions options = arguments.options;
  options.attributes = AttributeSet::all();
  options.more_paths.assign(arguments.paths.begin() + 1, arguments.paths.end());
  const std::unique_ptr<Recording> recording = open_any_recording(arguments.paths.front(), options);
  const Inspection inspection = inspect_recording(*recording, arguments.paths, options);
  if (!arguments.png.empty()) {
    const std::vector<std::byte> png = draw_inspection(inspection, intervals_of(*recording));
    write_text_atomically(arguments.png, {reinterpret_cast<const char*>(png.data()), png.size()});
  }
  if (arguments.json) {
    std::printf("%s\n", to_json(inspection).dump(2).c_str());
    return;
  }
  std::printf("%s", to_text(inspection).c_str());
  if (arguments.sketch || ::isatty(STDOUT_FILENO) != 0) {
    std::printf("\nscan %zu of %zu, %s\n", inspection.example_index, inspection.scans,
                sketch_scan(inspection.example, {72, locale_is_unicode()}).c_str());
  }
}

}  // namespace

void add_inspect_command(CLI::App& app, Context&) {
  CLI::App* command = app.add_subcommand(
      "inspect",
      "what a recording holds: format, sensor, stamps, gaps, a scan drawn, how to run it");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("RECORDING", arguments->paths,
                   "path of a recording, or of several bags of one, or sim:WORLD?key=value&...")
      ->required();
  add_reading_options(*command, arguments->options);
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->add_flag("--sketch", arguments->sketch,
                    "draw a scan with characters, where the output is no terminal, too");
  command->add_option("--png", arguments->png,
                      "picture of a scan, the times of its points and the intervals of the scans");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace groundloop::apps
