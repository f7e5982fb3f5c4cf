// What `groundloop evaluate closures` judges against: the local maps of one or several sessions as
// ground truth has them, rebuilt from the raw scans where their points are needed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "backend/session/session.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/core/trajectory.hpp"
#include "loopclosure/evaluation/evaluated_map.hpp"

namespace groundloop::apps {

/// One recording of a session.
struct EvaluatedPart {
  std::string name;
  std::string recording;
  std::string truth_frame;        ///< of that file, see ground_truth.hpp
  std::string ground_truth;       ///< a file, or empty: the recording's own
  std::filesystem::path session;  ///< folder of the session it belongs to
  std::filesystem::path tables;   ///< folder of its odometry.tum and local_maps.csv
  int first_map = 0;              ///< offset of its maps in the session's local_maps/
  std::vector<LocalMapRecord> maps;
  Trajectory odometry;
};

/// The parts of all sessions, in order. `recordings` and `ground_truths` replace those that the
/// manifests name, one a part; empty leaves them.
[[nodiscard]] std::vector<EvaluatedPart> read_parts(
    const std::vector<std::filesystem::path>& sessions, const std::vector<std::string>& recordings,
    const std::vector<std::string>& ground_truths, const std::string& truth_frame);

struct EvaluatedSessions {
  std::vector<EvaluatedMap> maps;  ///< keys count parts and the maps in each
  std::vector<std::string> notes;  ///< what is to be said of the ground truth
};

/// Ground truth of all maps, without points. Throws InputError where a recording has none, or none
/// at its scans' stamps.
[[nodiscard]] EvaluatedSessions evaluated_sessions(const std::vector<EvaluatedPart>& parts);

/// Rebuilds the points of all known maps from the scans, at ground-truth poses.
void rebuild_points(const std::vector<EvaluatedPart>& parts, std::vector<EvaluatedMap>& maps,
                    const Progress& progress);

/// The session's own points of a map.
[[nodiscard]] Points own_points(const std::vector<EvaluatedPart>& parts, const MapKey& key);

}  // namespace groundloop::apps
