// Options on how a recording is read, the same for every command that reads one.
#pragma once

#include <CLI/CLI.hpp>

#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

/// Adds --format, --topic, --fields, --dataset, --calibration, --time-unit and --stamp, which fill
/// `options`; it must live as long as the command.
void add_reading_options(CLI::App& command, RecordingOptions& options);

}  // namespace groundloop::apps
