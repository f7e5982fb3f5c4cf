// Points on their way into the world, some megabytes at a time: scans as the session kept them,
// each at its pose in the solution; or, where none were kept, a local map. The points of a local
// map were put together by odometry; what the solution made of odometry inside the map reaches them
// by the scan that stood nearest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "backend/map/point_tiles.hpp"
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

/// Where the scans of a recording lie.
struct PlacedScans {
  std::vector<Pose> T_world_scan;
  std::vector<std::size_t> first_scans;  ///< of the local maps, which partition the scans
};

/// A file of a session and how it lies.
struct MapPiece {
  std::filesystem::path file;                ///< a local map, written by write_pcd; or kept scans
  std::vector<ScanPlacement> placements;     ///< of a local map
  std::shared_ptr<const PlacedScans> scans;  ///< of kept scans; else none
  std::uint32_t map = 0;                     ///< number of the local map in its recording
  std::uint16_t session = 0;
};

/// The whole map at one pose.
[[nodiscard]] MapPiece rigid_piece(const std::filesystem::path& file, const Pose& T_world_map,
                                   std::uint16_t session = 0);
/// The map built from `odometry`, following `trajectory` (one pose a scan in both).
[[nodiscard]] MapPiece bent_piece(const std::filesystem::path& file, const LocalMapRecord& map,
                                  const Trajectory& odometry, const Trajectory& trajectory,
                                  std::uint16_t session = 0);

/// One recording of a session, maps and scans counted from 0.
struct RecordingLayout {
  const std::vector<LocalMapRecord>& maps;
  const Trajectory& odometry;
  const Trajectory& trajectory;
  int first_map = 0;  ///< in the session's numbers
  std::size_t first_scan_file = 0, scan_files = 0;
  std::uint16_t session = 0;
};
/// The recording's kept scans, or its local maps where there are none, in their order; without a
/// trajectory its local maps at their one pose each.
[[nodiscard]] std::vector<MapPiece> recording_pieces(const SessionFolder& folder,
                                                     const RecordingLayout& recording);

/// The points of a piece where the solution has them, tagged with the number of their local map;
/// those that are not finite are left out. Throws InputError naming the file where it is damaged,
/// or holds scans that the trajectory does not.
[[nodiscard]] std::vector<WorldPoint> points_in_world(const MapPiece& piece);

/// The largest intensity in the pieces, negative where none has any.
[[nodiscard]] float largest_intensity(const std::vector<MapPiece>& pieces);

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
