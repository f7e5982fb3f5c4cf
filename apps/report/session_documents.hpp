// The documents of a session that are JSON: manifest.json and metrics.json (design: the session
// folder).
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/mapping/slam.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

/// Errors of both trajectories where there is ground truth.
struct RunEvaluation {
  TrajectoryEvaluation odometry, optimised;
};

[[nodiscard]] nlohmann::ordered_json recording_document(const RecordingInfo& info,
                                                        std::size_t scans);

/// With checksums of the session's files, those that hold times or logs left out.
[[nodiscard]] nlohmann::ordered_json manifest_document(const SessionFolder& folder,
                                                       const Recording& recording,
                                                       const SlamResult& result,
                                                       const std::string& stage);

[[nodiscard]] nlohmann::ordered_json metrics_document(
    const SlamResult& result, const std::optional<RunEvaluation>& evaluation);

/// Peak resident memory of this process, MB.
[[nodiscard]] double peak_memory_mb();

}  // namespace groundloop::apps
