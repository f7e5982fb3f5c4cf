// Stable Triangle Descriptors (Yuan et al., ICRA 2023): key points where the borders of planes,
// projected onto them, hold many points. With its authors' settings for KITTI.
#pragma once

#include "tests/benchmarks/baselines/triangles.hpp"

namespace groundloop::baselines {

/// At most a hundred.
[[nodiscard]] std::vector<KeyPoint> border_corners(const PlaneVoxels& voxels);
/// Key points hold about as many points: twice the difference under half the sum, over the three.
[[nodiscard]] bool alike_in_points(const Triangle& a, const Triangle& b);

[[nodiscard]] MapPairs detect_by_std(const SessionScans& references, const SessionScans& queries);

}  // namespace groundloop::baselines
