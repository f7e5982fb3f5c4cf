// The scans of a session as rows of one table: where each is by odometry, in the solution and by
// the ground truth, all in one world, and by how much the first two err. Of very long sessions
// every n-th scan has a row.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "apps/report/session_contents.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"

namespace groundloop::apps {

/// The rows of one strand.
struct RowSpan {
  std::size_t first_row = 0;
  std::size_t rows = 0;
  std::size_t stride = 1;  ///< scans from row to row
};

/// Errors of a strand against its ground truth; each alignment is SE(3) without scale.
struct StrandEvaluation {
  std::optional<TrajectoryEvaluation> odometry;   ///< by an alignment of its own
  std::optional<TrajectoryEvaluation> optimised;  ///< by an alignment of its own
  /// By the alignment of all strands of its frame.
  std::optional<TrajectoryEvaluation> joint;
};

struct ScanTable {
  std::vector<RowSpan> spans;                               ///< one a strand
  std::vector<StrandEvaluation> evaluations;                ///< one a strand
  std::vector<std::optional<TrajectoryEvaluation>> frames;  ///< one a frame, all strands together
  std::vector<std::string> notes;  ///< of ground truth that could not be used, and why

  // One a row; poses in the world of the strand's frame.
  std::vector<Nanoseconds> stamps;
  std::vector<Pose> optimised;
  std::vector<Pose> odometry;  ///< placed so that the strand's first pose is the solution's
  std::vector<std::optional<Pose>> truth;  ///< brought there by the frame's alignment
  /// Estimate minus truth, m, in the axes of the frame's world, and degrees; NaN without truth.
  std::vector<Eigen::Vector3d> odometry_error, optimised_error;
  std::vector<double> odometry_error_deg, optimised_error_deg;

  [[nodiscard]] std::size_t rows() const { return stamps.size(); }
  /// The row nearest to a scan of a strand.
  [[nodiscard]] std::size_t row_of(std::size_t strand, std::size_t scan_in_strand) const;
};

/// `truths` are one a recording, each in its own world, and may be empty.
[[nodiscard]] ScanTable make_scan_table(const SessionContents& contents,
                                        const std::vector<Trajectory>& truths,
                                        std::size_t most_rows = 100'000);

/// The strand that holds a scan of a recording, and its place in it.
struct StrandScan {
  std::size_t strand = 0;
  std::size_t scan = 0;
};
[[nodiscard]] StrandScan strand_of(const SessionContents& contents, std::size_t part,
                                   std::size_t scan);

}  // namespace groundloop::apps
