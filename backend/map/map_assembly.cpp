#include "backend/map/map_assembly.hpp"

#include <algorithm>
#include <cmath>

#include "backend/map/point_tiles.hpp"
#include "backend/registration/voxel_pyramid.hpp"
#include "frontend/core/pcd.hpp"

namespace groundloop {
namespace {

// A whole number of voxels, so that no voxel lies in two tiles.
double tile_edge(const MapAssemblyOptions& options) {
  return options.voxel_size * std::max(1.0, std::round(options.tile_size / options.voxel_size));
}

// Looks placements up by the cell a point lies in, so that they are searched once a cell.
class Placements {
 public:
  explicit Placements(const MapPiece& piece) : placements_(piece.placements) {}

  [[nodiscard]] Eigen::Vector3d in_world(const Eigen::Vector3f& point) {
    return placement(point).T_world_map * Eigen::Vector3d(point.cast<double>());
  }

 private:
  static constexpr float kCell = 2.0F;  // m

  [[nodiscard]] const ScanPlacement& placement(const Eigen::Vector3f& point) {
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

  const std::vector<ScanPlacement>& placements_;
  VoxelTable cells_;
  std::vector<std::uint32_t> nearest_;
};

// One point a voxel: the mean, and the session that saw the voxel first.
std::vector<ExportPoint> downsample(const std::vector<TilePoint>& points, double voxel_size,
                                    const Eigen::Vector3d& corner) {
  struct Sum {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double count = 0.0;
    std::uint16_t session = 0;
  };
  const auto inverse = static_cast<float>(1.0 / voxel_size);
  VoxelTable table(points.size() / 4);
  std::vector<Sum> sums;
  for (const TilePoint& point : points) {
    if (!has_voxel(point.offset)) continue;
    const auto next = static_cast<std::uint32_t>(sums.size());
    const std::uint32_t number =
        table.find_or_insert(voxel_key(voxel_of(point.offset, inverse)), next);
    if (number == next)
      sums.push_back({Eigen::Vector3d::Zero(), 0.0, static_cast<std::uint16_t>(point.tag)});
    sums[number].position += point.offset.cast<double>();
    sums[number].count += 1.0;
  }
  std::vector<ExportPoint> result;
  result.reserve(sums.size());
  for (const Sum& sum : sums) result.push_back({corner + sum.position / sum.count, sum.session});
  return result;
}

void report(const Progress& progress, std::size_t done, std::size_t total) {
  if (progress) progress("map", done, total);
}

std::uint64_t assemble_all_points(const std::vector<MapPiece>& pieces, PointCloudWriter& writer,
                                  const Progress& progress) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    report(progress, i, pieces.size());
    std::vector<ExportPoint> points;
    for (const Eigen::Vector3d& point : points_in_world(pieces[i]))
      points.push_back({point, pieces[i].session});
    writer.write(points);
  }
  report(progress, pieces.size(), pieces.size());
  return writer.count();
}

}  // namespace

std::vector<Eigen::Vector3d> points_in_world(const MapPiece& piece) {
  std::vector<Eigen::Vector3d> points;
  Placements placements(piece);
  for (const Eigen::Vector3f& point : read_pcd(piece.file)) {
    if (point.allFinite()) points.push_back(placements.in_world(point));
  }
  return points;
}

MapPiece rigid_piece(const std::filesystem::path& file, const Pose& T_world_map,
                     std::uint16_t session) {
  return {file, {{Eigen::Vector3f::Zero(), T_world_map}}, session};
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
    piece.placements.push_back({place, trajectory[i].pose * T_map_scan.inverse()});
  }
  return piece;
}

std::uint64_t assemble_map(const std::vector<MapPiece>& pieces, const MapAssemblyOptions& options,
                           PointCloudWriter& writer, const std::filesystem::path& folder,
                           const Progress& progress) {
  validate(options, "map");
  if (options.voxel_size == 0.0) return assemble_all_points(pieces, writer, progress);
  PointTiles tiles(folder, tile_edge(options));
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    report(progress, i, 2 * pieces.size());
    tiles.add(points_in_world(pieces[i]), pieces[i].session);
  }
  const std::vector<PointTiles::Key> keys = tiles.keys();
  for (std::size_t k = 0; k < keys.size(); ++k) {
    report(progress, pieces.size() + k * pieces.size() / keys.size(), 2 * pieces.size());
    writer.write(downsample(tiles.read(keys[k]), options.voxel_size, tiles.corner(keys[k])));
  }
  report(progress, 2 * pieces.size(), 2 * pieces.size());
  return writer.count();
}

}  // namespace groundloop
