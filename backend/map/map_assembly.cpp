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
