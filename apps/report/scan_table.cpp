#include "apps/report/scan_table.hpp"

#include <algorithm>
#include <limits>

#include "apps/report/joint_evaluation.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Trajectory slice(const Trajectory& all, const Strand& strand) {
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(strand.first_scan);
  return {first, first + static_cast<std::ptrdiff_t>(strand.scans)};
}

std::optional<TrajectoryEvaluation> evaluated(const Trajectory& estimate, const Trajectory& truth,
                                              const std::string& name,
                                              std::vector<std::string>& notes) {
  if (truth.empty()) return std::nullopt;
  try {
    return evaluate_trajectory(estimate, truth);
  } catch (const InputError& e) {
    notes.push_back(name + ": " + e.what());
    return std::nullopt;
  }
}

void add_rows(const SessionContents& contents, const Strand& strand, std::size_t stride,
              ScanTable& table) {
  const SessionPart& part = contents.session.parts[strand.part];
  const Pose placed =
      part.trajectory[strand.first_scan].pose * part.odometry[strand.first_scan].pose.inverse();
  RowSpan span{table.rows(), 0, stride};
  for (std::size_t i = 0; i < strand.scans; i += stride) {
    const std::size_t scan = strand.first_scan + i;
    table.stamps.push_back(part.trajectory[scan].stamp);
    table.optimised.push_back(part.trajectory[scan].pose);
    table.odometry.push_back(placed * part.odometry[scan].pose);
    ++span.rows;
  }
  table.spans.push_back(span);
  table.truth.resize(table.rows());
  const Eigen::Vector3d unknown = Eigen::Vector3d::Constant(kNan);
  table.odometry_error.resize(table.rows(), unknown);
  table.optimised_error.resize(table.rows(), unknown);
  table.odometry_error_deg.resize(table.rows(), kNan);
  table.optimised_error_deg.resize(table.rows(), kNan);
}

// Errors of `evaluation`, whose pair k is pair `first` + k of the strand's `pairs`, into its rows.
// The evaluation's errors are truth minus estimate in the truth's axes.
void write_errors(const TrajectoryEvaluation& evaluation, std::size_t first,
                  const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                  const RowSpan& span, const Pose& T_truth_world,
                  std::vector<Eigen::Vector3d>& errors, std::vector<double>& degrees) {
  const Eigen::Quaterniond back = T_truth_world.rotation.conjugate();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (pairs[k].first % span.stride != 0) continue;
    const std::size_t row = span.first_row + pairs[k].first / span.stride;
    errors[row] = back * Eigen::Vector3d(-evaluation.translation_errors[first + k]);
    degrees[row] = evaluation.rotation_errors_deg[first + k];
  }
}

void write_truth(const StrandEvaluation& evaluation, const Trajectory& truth, const RowSpan& span,
                 const Pose& T_world_truth, ScanTable& table) {
  for (const auto& [scan, row] : evaluation.optimised->pairs) {
    if (scan % span.stride == 0)
      table.truth[span.first_row + scan / span.stride] = T_world_truth * truth[row].pose;
  }
}

// All strands of one frame with one alignment.
void evaluate_frame(const SessionContents& contents, const std::vector<Trajectory>& truths,
                    int frame, ScanTable& table) {
  JointPoses all;
  std::vector<std::size_t> strands;
  for (std::size_t s = 0; s < contents.strands.size(); ++s) {
    const Strand& strand = contents.strands[s];
    if (strand.frame != frame || !table.evaluations[s].optimised) continue;
    strands.push_back(s);
    all.add(slice(contents.session.parts[strand.part].trajectory, strand), truths[strand.part],
            table.evaluations[s].optimised->pairs);
  }
  table.frames.emplace_back();
  if (strands.empty()) return;
  const TrajectoryEvaluation joint = all.evaluate();
  table.frames.back() = joint;
  std::size_t first = 0;
  for (const std::size_t s : strands) {
    const Strand& strand = contents.strands[s];
    StrandEvaluation& own = table.evaluations[s];
    const Trajectory& truth = truths[strand.part];
    const auto& pairs = own.optimised->pairs;
    JointPoses alone;
    alone.add(slice(contents.session.parts[strand.part].trajectory, strand), truth, pairs);
    own.joint = alone.evaluate(joint.alignment);
    write_errors(joint, first, pairs, table.spans[s], joint.alignment.pose, table.optimised_error,
                 table.optimised_error_deg);
    if (own.odometry) {
      write_errors(*own.odometry, 0, own.odometry->pairs, table.spans[s], joint.alignment.pose,
                   table.odometry_error, table.odometry_error_deg);
    }
    write_truth(own, truth, table.spans[s], joint.alignment.pose.inverse(), table);
    first += pairs.size();
  }
}

}  // namespace

std::size_t ScanTable::row_of(std::size_t strand, std::size_t scan_in_strand) const {
  const RowSpan& span = spans[strand];
  return span.first_row + std::min(scan_in_strand / span.stride, span.rows - 1);
}

StrandScan strand_of(const SessionContents& contents, std::size_t part, std::size_t scan) {
  for (std::size_t s = 0; s < contents.strands.size(); ++s) {
    const Strand& strand = contents.strands[s];
    if (strand.part == part && scan >= strand.first_scan && scan < strand.first_scan + strand.scans)
      return {s, scan - strand.first_scan};
  }
  throw InputError("scan " + std::to_string(scan) + " is none of the session's");
}

ScanTable make_scan_table(const SessionContents& contents, const std::vector<Trajectory>& truths,
                          std::size_t most_rows) {
  std::size_t scans = 0;
  for (const Strand& strand : contents.strands) scans += strand.scans;
  const std::size_t stride = std::max<std::size_t>(1, (scans + most_rows - 1) / most_rows);
  ScanTable table;
  for (const Strand& strand : contents.strands) {
    add_rows(contents, strand, stride, table);
    const SessionPart& part = contents.session.parts[strand.part];
    const Trajectory& truth = truths[strand.part];
    StrandEvaluation evaluation;
    evaluation.optimised =
        evaluated(slice(part.trajectory, strand), truth, strand.name, table.notes);
    if (evaluation.optimised) {
      evaluation.odometry =
          evaluated(slice(part.odometry, strand), truth, strand.name, table.notes);
    }
    table.evaluations.push_back(std::move(evaluation));
  }
  for (std::size_t f = 0; f < contents.frame_names.size(); ++f)
    evaluate_frame(contents, truths, static_cast<int>(f), table);
  return table;
}

}  // namespace groundloop::apps
