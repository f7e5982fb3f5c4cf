// Reads what an evaluation of closures needs from a session folder, of one recording or merged, and
// rebuilds its local maps from the raw scans at ground-truth poses.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "backend/session/session.hpp"
#include "frontend/core/progress.hpp"
#include "loopclosure/evaluation/evaluation.hpp"

namespace groundloop::apps {

/// One recording of a session; maps are numbered from 0 in it.
struct EvaluatedPart {
  std::string name;
  std::string recording;
  std::filesystem::path tables;  ///< folder of its odometry.tum and local_maps.csv
  int first_map = 0;             ///< number of its map 0 in the session's local_maps/
};

struct ClosureEvaluationInput {
  std::vector<EvaluatedPart> parts;
  std::vector<EvaluatedMap> maps;
  std::vector<ReportedClosure> closures;
};

/// The parts of a session, by its manifest. `recordings` replace the manifest's, in order, and may
/// be empty. Throws InputError where they are not as many as there are parts.
[[nodiscard]] std::vector<EvaluatedPart> read_parts(const SessionFolder& session,
                                                    const std::vector<std::string>& recordings);

/// Reads tables and scans. `ground_truths` are files, one a part, or empty for what came with the
/// recordings. Throws InputError where a part has no ground truth or a scan is not in the
/// recording.
[[nodiscard]] ClosureEvaluationInput read_evaluation_input(
    const SessionFolder& session, const std::vector<std::string>& recordings,
    const std::vector<std::string>& ground_truths, const Progress& progress);

}  // namespace groundloop::apps
