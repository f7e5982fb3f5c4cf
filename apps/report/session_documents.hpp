// metrics.json of a run, and what its manifest says of the recording (design: the session folder).
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "apps/report/report_cost.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/evaluation/truth_frame.hpp"
#include "backend/mapping/slam.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

/// Errors of both trajectories where there is ground truth.
struct RunEvaluation {
  TrajectoryEvaluation odometry, optimised;
  Trajectory ground_truth;  ///< of the sensor
  TruthFrame frame;         ///< that it was in
  double instant_s = 0.0;   ///< from the scans' stamps at which it fits best
};

[[nodiscard]] nlohmann::ordered_json recording_document(const RecordingInfo& info,
                                                        std::size_t scans);

/// `report`: what writing report.html took, once it is written.
[[nodiscard]] nlohmann::ordered_json metrics_document(
    const SlamResult& result, const std::optional<RunEvaluation>& evaluation,
    const std::optional<ReportCost>& report);

/// Peak resident memory of this process, MB.
[[nodiscard]] double peak_memory_mb();

}  // namespace groundloop::apps
