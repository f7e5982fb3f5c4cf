// One run: recording in, session out. What `groundloop run` and `groundloop demo` share.
#pragma once

#include <filesystem>
#include <string>

#include "apps/commands/commands.hpp"
#include "apps/config/config.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

struct RunRequest {
  std::string recording;
  std::filesystem::path out;
  RecordingOptions reading;
  std::string ground_truth;  ///< file; empty: what came with the recording
  std::string truth_frame;   ///< see apps/commands/ground_truth.hpp
  Config config;
  bool overwrite = false;
  bool resume = false;
};

/// Runs all stages and leaves a session in `out`; prints what was found and the errors before and
/// after to standard error. What the end needs is checked at the start: ground truth that can be
/// read and fits the scans, a folder that can be written, room on the disk.
void run_recording(const RunRequest& request, Context& context);

}  // namespace groundloop::apps
