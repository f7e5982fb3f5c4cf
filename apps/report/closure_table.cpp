#include "apps/report/closure_table.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "backend/mapping/closure_anchor.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

const LocalMapRecord& map_of(const SessionContents& contents, std::size_t part, int map) {
  const std::vector<LocalMapRecord>& maps = contents.session.parts[part].maps;
  if (map < 0 || static_cast<std::size_t>(map) >= maps.size())
    throw InputError(contents.session.folder.file("closures.csv").string() + ": map " +
                     std::to_string(map) + " is none of the session's; run the recording again");
  return maps[static_cast<std::size_t>(map)];
}

// Of an edge query -> reference of the graph.
std::optional<PoseDifference> deviation_of(const SessionContents& contents, std::size_t query_part,
                                           int query_map, std::size_t reference_part,
                                           int reference_map) {
  const int from = contents.session.parts[query_part].first_map + query_map;
  const int to = contents.session.parts[reference_part].first_map + reference_map;
  for (const GraphEdge& edge : contents.session.graph.edges) {
    if (edge.from != from || edge.to != to || edge.kind != EdgeKind::closure) continue;
    const Eigen::LDLT<Matrix6d> factors(edge.information);
    if (factors.info() != Eigen::Success || !factors.isPositive()) return std::nullopt;
    const Matrix6d covariance = factors.solve(Matrix6d::Identity());
    const double translation = covariance.diagonal().head<3>().sum();
    const double rotation = covariance.diagonal().tail<3>().sum();
    if (!(translation >= 0.0 && rotation >= 0.0)) return std::nullopt;
    return PoseDifference{std::sqrt(translation), kDegrees * std::sqrt(rotation)};
  }
  return std::nullopt;
}

ClosureRow make_row(const SessionContents& contents, const ScanTable& table, std::size_t i) {
  const ClosureRecord& c = contents.session.closures[i];
  ClosureRow row;
  row.closure = i;
  row.reference_part = contents.part_index(c.reference_session);
  row.query_part = contents.part_index(c.query_session);
  const SessionPart& reference = contents.session.parts[row.reference_part];
  const SessionPart& query = contents.session.parts[row.query_part];
  const ClosureAnchor anchor = anchor_closure(
      c.T_query_reference, map_of(contents, row.reference_part, c.reference_map),
      reference.odometry, map_of(contents, row.query_part, c.query_map), query.odometry);
  row.reference_scan = strand_of(contents, row.reference_part, anchor.reference_scan);
  row.query_scan = strand_of(contents, row.query_part, anchor.query_scan);
  row.reference_row = table.row_of(row.reference_scan.strand, row.reference_scan.scan);
  row.query_row = table.row_of(row.query_scan.strand, row.query_scan.scan);
  row.T_scans = anchor.T_query_reference;
  const Strand& reference_strand = contents.strands[row.reference_scan.strand];
  const Strand& query_strand = contents.strands[row.query_scan.strand];
  row.one_frame = reference_strand.frame == query_strand.frame;
  if (row.one_frame) {
    const Pose solution = query.trajectory[anchor.query_scan].pose.inverse() *
                          reference.trajectory[anchor.reference_scan].pose;
    row.residual = difference(solution, row.T_scans);
  }
  if (row.reference_scan.strand == row.query_scan.strand) {
    const Pose odometry = query.odometry[anchor.query_scan].pose.inverse() *
                          reference.odometry[anchor.reference_scan].pose;
    row.correction = difference(odometry, row.T_scans);
  }
  // Rows of a thinned table hold the truth of their own scans only.
  const auto& truth_r = table.truth[row.reference_row];
  const auto& truth_q = table.truth[row.query_row];
  if (row.one_frame && truth_r && truth_q && table.spans[row.query_scan.strand].stride == 1)
    row.error = difference(truth_q->inverse() * *truth_r, row.T_scans);
  if (c.overlap || c.rmse) row.moved = difference(c.initial_T_query_reference, c.T_query_reference);
  if (c.status == ClosureStatus::accepted) {
    row.deviation =
        deviation_of(contents, row.query_part, c.query_map, row.reference_part, c.reference_map);
  }
  return row;
}

}  // namespace

PoseDifference difference(const Pose& a, const Pose& b) {
  const Pose d = a.inverse() * b;
  return {d.translation.norm(), kDegrees * rotation_angle(d.rotation)};
}

std::vector<ClosureRow> make_closure_rows(const SessionContents& contents, const ScanTable& table) {
  std::vector<ClosureRow> rows;
  for (std::size_t i = 0; i < contents.session.closures.size(); ++i)
    rows.push_back(make_row(contents, table, i));
  return rows;
}

}  // namespace groundloop::apps
