// A local map on its way into the world. Its points were put together by odometry; what the
// solution made of odometry inside the map reaches them by the scan that stood nearest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "backend/session/session.hpp"
#include "frontend/core/pose.hpp"
#include "frontend/core/trajectory.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {

/// Where a scan stood in its local map, and where the map lies as this scan has it.
struct ScanPlacement {
  Eigen::Vector3f place;  ///< m, in the map's frame
  Pose T_world_map;
  std::size_t scan = 0;  ///< its place in the trajectory
};

/// A local map as a session keeps it.
struct MapPiece {
  std::filesystem::path file;  ///< written by write_pcd
  std::vector<ScanPlacement> placements;
  std::uint16_t session = 0;
};

/// The whole map at one pose.
[[nodiscard]] MapPiece rigid_piece(const std::filesystem::path& file, const Pose& T_world_map,
                                   std::uint16_t session = 0);
/// The map built from `odometry`, following `trajectory` (one pose a scan in both).
[[nodiscard]] MapPiece bent_piece(const std::filesystem::path& file, const LocalMapRecord& map,
                                  const Trajectory& odometry, const Trajectory& trajectory,
                                  std::uint16_t session = 0);

/// The points of a piece where the solution has them; those that are not finite are left out.
[[nodiscard]] std::vector<Eigen::Vector3d> points_in_world(const MapPiece& piece);

/// Looks placements up by the cell of 2 m that a point lies in, so that they are searched once a
/// cell. The piece must outlive it.
class PlacementIndex {
 public:
  explicit PlacementIndex(const MapPiece& piece) : placements_(piece.placements) {}

  /// Of the scan that stood nearest to `point` (map frame, m).
  [[nodiscard]] const ScanPlacement& nearest(const Eigen::Vector3f& point);
  [[nodiscard]] Eigen::Vector3d in_world(const Eigen::Vector3f& point) {
    return nearest(point).T_world_map * Eigen::Vector3d(point.cast<double>());
  }

 private:
  const std::vector<ScanPlacement>& placements_;
  VoxelTable cells_;
  std::vector<std::uint32_t> nearest_;
};

}  // namespace groundloop
