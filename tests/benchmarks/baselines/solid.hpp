// SOLiD (Kim et al., RA-L 2024): counts of a scan's points by range and elevation, each elevation
// weighted by how many points it has. With its authors' settings: 40 ranges from 3 to 80 m, 32
// elevations, voxels of 0.4 m. All scans that may be reported are candidates (Sec. 4.2 of the
// paper).
#pragma once

#include <Eigen/Core>

#include "tests/benchmarks/baselines/session_scans.hpp"

namespace groundloop::baselines {

struct FieldOfView {
  double down_deg = -24.8, up_deg = 2.0;
};
/// From the lowest to the highest elevation of a sensor's points, a two-hundredth at either end
/// left out: 2 and -24.8 degrees for KITTI's, which its authors give.
[[nodiscard]] FieldOfView field_of_view(const std::vector<Points>& scans);

using Solid = Eigen::Matrix<double, 40, 1>;
/// The part of the descriptor that places are recognised by.
[[nodiscard]] Solid solid(const Points& points, const FieldOfView& view);
[[nodiscard]] double solid_similarity(const Solid& a, const Solid& b);

[[nodiscard]] MapPairs detect_by_solid(const SessionScans& references, const SessionScans& queries);

}  // namespace groundloop::baselines
