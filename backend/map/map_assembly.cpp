#include "backend/map/map_assembly.hpp"

#include <algorithm>
#include <cmath>

#include "backend/map/point_tiles.hpp"
#include "backend/registration/voxel_pyramid.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

// A whole number of voxels, so that no voxel lies in two tiles.
double tile_edge(const MapAssemblyOptions& options) {
  return options.voxel_size * std::max(1.0, std::round(options.tile_size / options.voxel_size));
}

// Files, and tiles, that are worked on at a time: enough for a few cores, few enough for memory.
constexpr std::size_t kAtATime = 4;

// One point a voxel: the mean, and the session that saw the voxel first.
class VoxelMeans {
 public:
  explicit VoxelMeans(double voxel_size) : inverse_(static_cast<float>(1.0 / voxel_size)) {}

  void add(std::span<const TilePoint> points) {
    for (const TilePoint& point : points) {
      if (!has_voxel(point.offset)) continue;
      const auto next = static_cast<std::uint32_t>(sums_.size());
      const std::uint32_t number =
          table_.find_or_insert(voxel_key(voxel_of(point.offset, inverse_)), next);
      if (number == next) sums_.push_back({Eigen::Vector3d::Zero(), 0.0, 0.0, point.tag});
      Sum& sum = sums_[number];
      const double weight = point.weight;
      sum.position += weight * point.offset.cast<double>();
      sum.intensity += weight * static_cast<double>(point.intensity);
      sum.weight += weight;
    }
  }

  [[nodiscard]] std::vector<TilePoint> tile_points() const {
    std::vector<TilePoint> points;
    points.reserve(sums_.size());
    for (const Sum& sum : sums_) {
      points.push_back({(sum.position / sum.weight).cast<float>(),
                        static_cast<float>(sum.intensity / sum.weight),
                        static_cast<float>(sum.weight), sum.session});
    }
    return points;
  }

  [[nodiscard]] std::vector<ExportPoint> export_points(const Eigen::Vector3d& corner) const {
    std::vector<ExportPoint> points;
    points.reserve(sums_.size());
    for (const Sum& sum : sums_) {
      points.push_back({corner + sum.position / sum.weight, static_cast<std::uint16_t>(sum.session),
                        static_cast<float>(sum.intensity / sum.weight)});
    }
    return points;
  }

 private:
  struct Sum {
    Eigen::Vector3d position;
    double intensity, weight;
    std::uint32_t session;
  };

  float inverse_;
  VoxelTable table_;
  std::vector<Sum> sums_;
};

std::vector<WorldPoint> points_by_session(const MapPiece& piece) {
  std::vector<WorldPoint> points = points_in_world(piece);
  for (WorldPoint& point : points) point.tag = piece.session;
  return points;
}

// The means of a piece's own voxels: successive scans see much the same.
PointTiles::Sorted means_of(const MapPiece& piece, const PointTiles& tiles, double voxel_size) {
  PointTiles::Sorted sorted = tiles.sort(points_by_session(piece));
  for (auto& [key, points] : sorted) {
    VoxelMeans means(voxel_size);
    means.add(points);
    points = means.tile_points();
  }
  return sorted;
}

void report(const Progress& progress, std::size_t done, std::size_t total) {
  if (progress) progress("map", done, total);
}

std::uint64_t assemble_all_points(const std::vector<MapPiece>& pieces, PointCloudWriter& writer,
                                  const Progress& progress) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    report(progress, i, pieces.size());
    std::vector<ExportPoint> points;
    for (const WorldPoint& point : points_in_world(pieces[i]))
      points.push_back({point.position, pieces[i].session, point.intensity});
    writer.write(points);
  }
  report(progress, pieces.size(), pieces.size());
  return writer.count();
}

// Calls make(i) for each i of [0, n) on all cores, a few at a time, and use(result) in their order.
template <typename Make, typename Use>
void in_order(std::size_t n, Make&& make, Use&& use) {
  for (std::size_t first = 0; first < n; first += kAtATime) {
    const std::size_t count = std::min(kAtATime, n - first);
    std::vector<decltype(make(first))> results(count);
    parallel_for(count, 1, [&](std::size_t i) { results[i] = make(first + i); });
    for (std::size_t i = 0; i < count; ++i) use(first + i, results[i]);
  }
}

}  // namespace

ExportFields fields_of(const std::vector<MapPiece>& pieces, bool session) {
  const float largest = largest_intensity(pieces);
  return {session, largest >= 0.0F, std::max(largest, 0.0F)};
}

std::uint64_t assemble_map(const std::vector<MapPiece>& pieces, const MapAssemblyOptions& options,
                           PointCloudWriter& writer, const std::filesystem::path& folder,
                           const Progress& progress) {
  validate(options, "map");
  if (options.voxel_size == 0.0) return assemble_all_points(pieces, writer, progress);
  PointTiles tiles(folder, tile_edge(options));
  in_order(
      pieces.size(), [&](std::size_t i) { return means_of(pieces[i], tiles, options.voxel_size); },
      [&](std::size_t i, const PointTiles::Sorted& means) {
        report(progress, i, 2 * pieces.size());
        tiles.append(means);
      });
  const std::vector<PointTiles::Key> keys = tiles.keys();
  in_order(
      keys.size(),
      [&](std::size_t k) {
        VoxelMeans means(options.voxel_size);
        tiles.for_each_chunk(keys[k], [&](std::span<const TilePoint> part) { means.add(part); });
        return means.export_points(tiles.corner(keys[k]));
      },
      [&](std::size_t k, const std::vector<ExportPoint>& points) {
        report(progress, pieces.size() + k * pieces.size() / keys.size(), 2 * pieces.size());
        writer.write(points);
      });
  report(progress, 2 * pieces.size(), 2 * pieces.size());
  return writer.count();
}

}  // namespace groundloop
