// Trajectory evaluation as JSON (Sec. 4 of the design) and as the table that people read.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/evaluation/truth_frame.hpp"
#include "backend/evaluation/visit_distance.hpp"

namespace groundloop::apps {

/// {rmse, mean, median, std, min, max}
[[nodiscard]] nlohmann::ordered_json to_json(const Statistics& statistics);
/// {translation_m: {...}, rotation_deg: {...}}
[[nodiscard]] nlohmann::ordered_json to_json(const PoseErrorStatistics& statistics);
/// {pairs, alignment, ..., ape, rpe, kitti}
[[nodiscard]] nlohmann::ordered_json to_json(const TrajectoryEvaluation& evaluation,
                                             const TrajectoryEvaluationOptions& options);
/// {frame, rotation_deg, lever_m: [x, y, z], found, fits, disagreement_percent, disagreement_deg}
[[nodiscard]] nlohmann::ordered_json to_json(const TruthFrame& frame);
/// {definition, by_way: {pairs, median_m, p95_m}, by_time: {...}}; figures without pairs are null.
[[nodiscard]] nlohmann::ordered_json to_json(const VisitDistances& visits);
[[nodiscard]] std::string to_table(const TrajectoryEvaluation& evaluation,
                                   const TrajectoryEvaluationOptions& options);
[[nodiscard]] std::string to_table(const VisitDistances& visits);

}  // namespace groundloop::apps
