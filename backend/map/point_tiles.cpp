#include "backend/map/point_tiles.hpp"

#include <cmath>

namespace groundloop {

static_assert(sizeof(TilePoint) == 24);

PointTiles::PointTiles(const std::filesystem::path& folder, double edge)
    : edge_(edge), file_(folder) {}

PointTiles::Sorted PointTiles::sort(std::span<const WorldPoint> points) const {
  Sorted tiles;
  std::vector<TilePoint>* tile = nullptr;  // of the point before: most often this one's, too
  Key last;
  for (const WorldPoint& point : points) {
    const double x = std::floor(point.position.x() / edge_);
    const double y = std::floor(point.position.y() / edge_);
    if (!(std::abs(x) < 1e9 && std::abs(y) < 1e9 && std::isfinite(point.position.z()))) continue;
    const Key key{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
    if (tile == nullptr || key != last) tile = &tiles[key];
    last = key;
    const Eigen::Vector3d offset = point.position - Eigen::Vector3d(x * edge_, y * edge_, 0.0);
    tile->push_back({offset.cast<float>(), point.intensity, 1.0F, point.tag});
  }
  return tiles;
}

void PointTiles::append(const Sorted& points) {
  for (const auto& [key, sorted] : points)
    chunks_[key].push_back({file_.append(std::as_bytes(std::span(sorted))), sorted.size()});
}

std::vector<PointTiles::Key> PointTiles::keys() const {
  std::vector<Key> keys;
  for (const auto& [key, chunks] : chunks_) keys.push_back(key);
  return keys;
}

void PointTiles::for_each_chunk(const Key& key,
                                const std::function<void(std::span<const TilePoint>)>& f) const {
  std::vector<TilePoint> points;
  for (const Chunk& chunk : chunks_.at(key)) {
    points.resize(chunk.count);
    file_.read(chunk.offset, std::as_writable_bytes(std::span(points)));
    f(points);
  }
}

}  // namespace groundloop
