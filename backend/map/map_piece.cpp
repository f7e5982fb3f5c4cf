#include "backend/map/map_piece.hpp"

#include <algorithm>

#include "backend/registration/voxel_pyramid.hpp"
#include "frontend/core/pcd.hpp"

namespace groundloop {

MapPiece rigid_piece(const std::filesystem::path& file, const Pose& T_world_map,
                     std::uint16_t session) {
  return {file, {{Eigen::Vector3f::Zero(), T_world_map, 0}}, session};
}

MapPiece bent_piece(const std::filesystem::path& file, const LocalMapRecord& map,
                    const Trajectory& odometry, const Trajectory& trajectory,
                    std::uint16_t session) {
  constexpr float kApart = 1.0F;  // m; scans in between say nothing new
  MapPiece piece{file, {}, session};
  for (std::size_t i = map.first_scan; i <= map.last_scan; ++i) {
    const Pose T_map_scan = odometry[map.first_scan].pose.inverse() * odometry[i].pose;
    const Eigen::Vector3f place = T_map_scan.translation.cast<float>();
    if (i > map.first_scan && (place - piece.placements.back().place).norm() < kApart) continue;
    piece.placements.push_back({place, trajectory[i].pose * T_map_scan.inverse(), i});
  }
  return piece;
}

const ScanPlacement& PlacementIndex::nearest(const Eigen::Vector3f& point) {
  constexpr float kCell = 2.0F;  // m
  if (placements_.size() == 1 || !has_voxel(point)) return placements_.front();
  const Eigen::Vector3i cell = voxel_of(point, 1.0F / kCell);
  const auto next = static_cast<std::uint32_t>(nearest_.size());
  const std::uint32_t number = cells_.find_or_insert(voxel_key(cell), next);
  if (number == next) {
    const Eigen::Vector3f centre = (cell.cast<float>().array() + 0.5F).matrix() * kCell;
    const auto nearest = std::min_element(placements_.begin(), placements_.end(),
                                          [&](const ScanPlacement& a, const ScanPlacement& b) {
                                            return (a.place - centre).squaredNorm() <
                                                   (b.place - centre).squaredNorm();
                                          });
    nearest_.push_back(static_cast<std::uint32_t>(nearest - placements_.begin()));
  }
  return placements_[nearest_[number]];
}

std::vector<Eigen::Vector3d> points_in_world(const MapPiece& piece) {
  std::vector<Eigen::Vector3d> points;
  PlacementIndex placements(piece);
  for (const Eigen::Vector3f& point : read_pcd(piece.file)) {
    if (point.allFinite()) points.push_back(placements.in_world(point));
  }
  return points;
}

}  // namespace groundloop
