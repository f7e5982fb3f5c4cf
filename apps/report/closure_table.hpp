// The closures of a session with what a report says beyond closures.csv: which scans met, by how
// much the closure is off the ground truth and off the solution, and how certain it was.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "apps/report/scan_table.hpp"
#include "apps/report/session_contents.hpp"

namespace groundloop::apps {

/// A distance and an angle between two poses.
struct PoseDifference {
  double m = 0.0;
  double deg = 0.0;
};
[[nodiscard]] PoseDifference difference(const Pose& a, const Pose& b);

struct ClosureRow {
  std::size_t closure = 0;  ///< place in the session's closures
  std::size_t reference_part = 0, query_part = 0;
  /// The scans of the two maps that came closest by the closure's pose, and their rows.
  StrandScan reference_scan, query_scan;
  std::size_t reference_row = 0, query_row = 0;
  Pose T_scans;                              ///< T_query_reference of those two scans
  bool one_frame = false;                    ///< of the scans: only then there is a residual
  std::optional<PoseDifference> error;       ///< against the ground truth, at the scans that met
  std::optional<PoseDifference> residual;    ///< against the solution, likewise
  std::optional<PoseDifference> correction;  ///< of odometry, likewise: what the closure tells
  std::optional<PoseDifference> moved;       ///< by registration, of the detector's pose
  /// Standard deviation of the closure's position and rotation, by its information in the graph.
  std::optional<PoseDifference> deviation;
};

/// One a closure, in their order.
[[nodiscard]] std::vector<ClosureRow> make_closure_rows(const SessionContents& contents,
                                                        const ScanTable& table);

}  // namespace groundloop::apps
