// `export` to .csv: the poses of a session's scans, or of one scan in another, with how well each
// is known.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

namespace groundloop::apps {

struct PoseExport {
  std::filesystem::path session, out;
  bool uncertainty = false;
  std::optional<std::size_t> from, to;  ///< scans, numbered through the session; both or none
};

/// Returns the number of poses written. Throws InputError where the session or a scan does not
/// exist, or no chain of closures joins the two.
std::size_t export_poses(const PoseExport& request);

}  // namespace groundloop::apps
