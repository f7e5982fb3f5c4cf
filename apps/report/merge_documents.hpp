// The documents of a merged session: manifest.json and metrics.json.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/config/config.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/merging/session_merge.hpp"
#include "backend/session/manifest.hpp"

namespace groundloop::apps {

/// Errors against ground truth, one entry a recording; empty where there is none.
struct MergeEvaluation {
  std::vector<Trajectory> ground_truth;
  std::vector<std::optional<TrajectoryEvaluation>> odometry;
  std::vector<std::optional<TrajectoryEvaluation>> optimised;
  /// Without an alignment of its own: by that of the recording that names the frame. What of the
  /// error lies between the two.
  std::vector<std::optional<TrajectoryEvaluation>> by_reference;
  /// All recordings of the first frame with one alignment. The recordings' ground truths must be in
  /// one world.
  std::optional<TrajectoryEvaluation> joint;
  /// Of the accepted closures between recordings, against ground truth: position and angle.
  std::vector<std::pair<double, double>> closure_errors;
};

[[nodiscard]] MergeEvaluation evaluate_merge(const MergeResult& result,
                                             std::vector<Trajectory> ground_truth);

/// The manifest of a complete merge, with checksums of the files in `folder`.
[[nodiscard]] Manifest merge_manifest(const SessionFolder& folder, const MergeResult& result,
                                      const std::vector<StoredSession>& sessions,
                                      const std::vector<ManifestLeftOut>& left_out);

[[nodiscard]] nlohmann::ordered_json merge_metrics(const MergeResult& result,
                                                   const MergeEvaluation& evaluation,
                                                   double map_seconds, double total_seconds);

}  // namespace groundloop::apps
