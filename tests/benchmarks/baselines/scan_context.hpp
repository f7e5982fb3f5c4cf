// Scan Context (Kim and Kim, IROS 2018): a scan as the greatest heights in sectors of rings,
// compared by the cosine of its sectors over all turns; candidates by the means of the rings. With
// its authors' settings: 20 rings, 60 sectors, 80 m, 10 candidates.
#pragma once

#include <Eigen/Core>

#include "tests/benchmarks/baselines/session_scans.hpp"

namespace groundloop::baselines {

constexpr int kRings = 20, kSectors = 60;
using ScanContext = Eigen::Matrix<double, kRings, kSectors>;
using RingKey = Eigen::Matrix<double, kRings, 1>;

/// Greatest height above 2 m below the sensor (its authors' mounting height); 0 where there is
/// none.
[[nodiscard]] ScanContext scan_context(const Points& points);
[[nodiscard]] RingKey ring_key(const ScanContext& context);
/// The least mean cosine distance between sectors that both have something in, over all turns of b.
[[nodiscard]] double scan_context_distance(const ScanContext& a, const ScanContext& b);

/// Similarity is one less the distance. There is no pose beyond the turn.
[[nodiscard]] MapPairs detect_by_scan_context(const SessionScans& references,
                                              const SessionScans& queries);

}  // namespace groundloop::baselines
