// report.html: one self-contained page about a run, readable without a network. Pictures are inline
// SVG, so that they print and zoom; every figure stands beside its definition.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backend/evaluation/trajectory_evaluation.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::apps {

/// A row of closures.csv with what the page shows beyond it.
struct ReportClosure {
  std::string reference, query;  ///< "3", or "session/3" where there are several sessions
  std::string source;            ///< "detector" or "overlap"
  int matches = 0, inliers = 0;
  std::string status;
  std::optional<double> overlap, rmse_m;
  /// Of the closure against ground truth, at the scans that met.
  std::optional<double> error_m, error_deg;
  /// Of the two scans that met, or of the maps' origins, in the optimised trajectory (world, m).
  Eigen::Vector3d reference_position = Eigen::Vector3d::Zero();
  Eigen::Vector3d query_position = Eigen::Vector3d::Zero();
};

struct ReportTable {
  std::string title;
  std::string note;  ///< under the title
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// Pictures in a row under one caption.
struct ReportImage {
  std::string caption;
  std::vector<std::vector<std::byte>> pngs;
};

struct PrecisionRecallPoint {
  int min_inliers = 0;
  double precision = 0.0, recall = 0.0;
};

/// One of several sessions in a common frame.
struct ReportSession {
  std::string name;
  Trajectory trajectory;
};

/// What is empty is left out of the page.
struct ReportInput {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  ///< recording, sensor, notes, version
  Trajectory odometry;                                     ///< before closing loops, world
  Trajectory optimised;                                    ///< after, world
  std::vector<ReportSession> sessions;                     ///< drawn in colours instead of those
  Trajectory ground_truth;  ///< in its own frame; what the evaluations below were made with
  std::optional<TrajectoryEvaluation> odometry_evaluation, optimised_evaluation;
  TrajectoryEvaluationOptions evaluation_options;
  std::vector<ReportClosure> closures;
  std::vector<PrecisionRecallPoint> precision_recall;
  std::vector<ReportTable> tables;  ///< map quality, counts, pose graph
  std::vector<std::pair<std::string, double>> timing_s;
  std::vector<ReportImage> images;  ///< density images of closures
  std::string configuration;        ///< the effective YAML
};

/// The whole page.
[[nodiscard]] std::string make_report(const ReportInput& input);

}  // namespace groundloop::apps
