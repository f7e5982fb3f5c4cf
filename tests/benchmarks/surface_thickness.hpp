// How thick surfaces come out where successive scans are put together by their poses: a measure of
// odometry and deskewing that needs no ground truth.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"

namespace groundloop {

/// Takes scans one after another. Of each window of scans points are gathered in cells of 1 m; the
/// thickness of a cell is the standard deviation across the plane through its points, and it counts
/// where the points span a plane (30 points of three scans or more, twice as wide as thick in both
/// directions).
class SurfaceThickness {
 public:
  explicit SurfaceThickness(std::size_t scans_of_a_window = 40) : window_(scans_of_a_window) {}
  /// Points in the scan frame, m.
  void add(const Points& points, const Pose& T_world_scan);
  /// Of all cells of all whole windows, m; 0 where there are none.
  [[nodiscard]] double median();

 private:
  void measure();

  std::size_t window_;
  std::vector<std::pair<Points, Pose>> scans_;
  std::vector<double> thicknesses_;
};

}  // namespace groundloop
