// Thins the points of a map to what a browser takes, in one pass and bounded memory: one point a
// voxel, in voxels that grow until no more than twice the wanted number are occupied. Of several
// points the one nearest to the voxel's centre stays, so that what is shown was measured, and the
// order of points matters only among equals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/voxel_table.hpp"

namespace groundloop::apps {

/// A point of the map and the row of the trajectory whose scan stood nearest to it.
struct MapPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< world, m
  std::uint32_t row = 0;
};

class PointSampler {
 public:
  /// `wanted` points at least one; voxels start at `finest` (m) and grow by the square root of two.
  explicit PointSampler(std::size_t wanted, float finest = 0.1F);

  /// A point that is not finite, or too far for a voxel's key, is left out.
  void add(const MapPoint& point);

  /// Edge of the voxels by now, m.
  [[nodiscard]] float voxel_size() const { return voxel_size_; }
  /// At most twice as many as were wanted, one a voxel.
  [[nodiscard]] const std::vector<MapPoint>& points() const { return points_; }
  [[nodiscard]] std::vector<MapPoint> take() { return std::move(points_); }

 private:
  void insert(const MapPoint& point);
  void coarsen();

  std::size_t wanted_;
  float voxel_size_;
  VoxelTable table_;
  std::vector<MapPoint> points_;
};

}  // namespace groundloop::apps
