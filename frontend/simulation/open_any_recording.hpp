// A recording by its path, or a simulated one by its specification: what the command and the tests
// open. Readers of files know nothing of the simulation.
#pragma once

#include <memory>
#include <string>

#include "frontend/recordings/recording.hpp"

namespace groundloop {

/// open_recording, and `sim:...` beside it. Throws InputError as they do.
[[nodiscard]] std::unique_ptr<Recording> open_any_recording(const std::string& path,
                                                            const RecordingOptions& options = {});

}  // namespace groundloop
