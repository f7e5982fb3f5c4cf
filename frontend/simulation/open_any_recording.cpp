#include "frontend/simulation/open_any_recording.hpp"

#include "frontend/recordings/wrappers.hpp"
#include "frontend/simulation/simulation.hpp"

namespace groundloop {

std::unique_ptr<Recording> open_any_recording(const std::string& path,
                                              const RecordingOptions& options) {
  if (options.format != "sim" && !(options.format.empty() && is_simulation(path)))
    return open_recording(path, options);
  return recordings::wrap(open_simulation(path), options);
}

}  // namespace groundloop
