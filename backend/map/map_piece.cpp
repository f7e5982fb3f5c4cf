#include "backend/map/map_piece.hpp"

#include <algorithm>

#include "backend/registration/voxel_pyramid.hpp"
#include "backend/session/scan_file.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/pcd.hpp"

namespace groundloop {
namespace {

std::vector<WorldPoint> placed_map(const MapPiece& piece) {
  std::vector<WorldPoint> points;
  PlacementIndex placements(piece);
  for (const Eigen::Vector3f& point : read_pcd(piece.file)) {
    if (point.allFinite()) points.push_back({placements.in_world(point), 0.0F, piece.map});
  }
  return points;
}

std::vector<WorldPoint> placed_scans(const MapPiece& piece) {
  std::vector<WorldPoint> points;
  const std::vector<Pose>& poses = piece.scans->T_world_scan;
  const std::vector<std::size_t>& firsts = piece.scans->first_scans;
  for (const KeptScan& scan : read_scan_file(piece.file)) {
    if (scan.scan >= poses.size()) {
      throw InputError(piece.file.string() + ": holds scan " + std::to_string(scan.scan) + " of " +
                       std::to_string(poses.size()) + "; run the session again");
    }
    const Pose& T_world_scan = poses[scan.scan];
    const Eigen::Matrix3d rotation = T_world_scan.rotation.toRotationMatrix();
    const auto after = std::upper_bound(firsts.begin(), firsts.end(), std::size_t{scan.scan});
    const auto map = static_cast<std::uint32_t>(
        std::max<std::ptrdiff_t>(0, std::distance(firsts.begin(), after) - 1));
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      points.push_back({rotation * scan.points[i].cast<double>() + T_world_scan.translation,
                        scan.intensity.empty() ? 0.0F : scan.intensity[i], map});
    }
  }
  return points;
}

}  // namespace

MapPiece rigid_piece(const std::filesystem::path& file, const Pose& T_world_map,
                     std::uint16_t session) {
  return {file, {{Eigen::Vector3f::Zero(), T_world_map, 0}}, nullptr, 0, session};
}

MapPiece bent_piece(const std::filesystem::path& file, const LocalMapRecord& map,
                    const Trajectory& odometry, const Trajectory& trajectory,
                    std::uint16_t session) {
  constexpr float kApart = 1.0F;  // m; scans in between say nothing new
  MapPiece piece{file, {}, nullptr, 0, session};
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

std::vector<MapPiece> recording_pieces(const SessionFolder& folder,
                                       const RecordingLayout& recording) {
  std::vector<MapPiece> pieces;
  const bool bent = !recording.trajectory.empty();
  if (!bent || recording.scan_files == 0) {
    for (const LocalMapRecord& map : recording.maps) {
      const std::filesystem::path file = folder.local_map(recording.first_map + map.map);
      pieces.push_back(
          bent ? bent_piece(file, map, recording.odometry, recording.trajectory, recording.session)
               : rigid_piece(file, map.T_world_map, recording.session));
      pieces.back().map = static_cast<std::uint32_t>(map.map);
    }
    return pieces;
  }
  const auto placed = std::make_shared<PlacedScans>();
  for (const StampedPose& sample : recording.trajectory)
    placed->T_world_scan.push_back(sample.pose);
  for (const LocalMapRecord& map : recording.maps) placed->first_scans.push_back(map.first_scan);
  for (std::size_t n = 0; n < recording.scan_files; ++n) {
    pieces.push_back(
        {folder.scan_file(recording.first_scan_file + n), {}, placed, 0, recording.session});
  }
  return pieces;
}

std::vector<WorldPoint> points_in_world(const MapPiece& piece) {
  return piece.scans ? placed_scans(piece) : placed_map(piece);
}

float largest_intensity(const std::vector<MapPiece>& pieces) {
  float largest = -1.0F;
  for (const MapPiece& piece : pieces) {
    if (piece.scans) largest = std::max(largest, largest_intensity_of(piece.file));
  }
  return largest;
}

}  // namespace groundloop
