// What `groundloop run` should be given for a recording, and what is missing or would help.
#pragma once

#include <string>
#include <vector>

#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

struct ProposedRun {
  std::string command;              ///< for a shell
  std::vector<std::string> to_add;  ///< what would make the result better, one sentence each
};

/// `paths` and `options` as the user gave them. Looks beside the recording for files that hold
/// ground truth of its scans.
[[nodiscard]] ProposedRun propose_run(const std::vector<std::string>& paths,
                                      const RecordingOptions& options, const Recording& recording);

/// A word for a shell: in quotes where it needs them.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace groundloop::apps
