#include "apps/commands/reading_options.hpp"

namespace groundloop::apps {

void add_reading_options(CLI::App& command, RecordingOptions& options) {
  command.add_option("--format", options.format, "format, where it is not recognised");
  command.add_option("--topic", options.topic, "topic or sensor, where there are several");
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
