#include "backend/map/point_tiles.hpp"

#include <cmath>

namespace groundloop {

static_assert(sizeof(TilePoint) == 16);

PointTiles::PointTiles(const std::filesystem::path& folder, double edge)
    : edge_(edge), file_(folder) {}

void PointTiles::add(std::span<const Eigen::Vector3d> points, std::uint32_t tag) {
  std::map<Key, std::vector<TilePoint>> tiles;
  for (const Eigen::Vector3d& point : points) {
    const double x = std::floor(point.x() / edge_);
    const double y = std::floor(point.y() / edge_);
    if (!(std::abs(x) < 1e9 && std::abs(y) < 1e9 && std::isfinite(point.z()))) continue;
    const Eigen::Vector3d offset = point - Eigen::Vector3d(x * edge_, y * edge_, 0.0);
    tiles[{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}].push_back(
        {offset.cast<float>(), tag});
  }
  for (const auto& [key, sorted] : tiles)
    chunks_[key].push_back({file_.append(std::as_bytes(std::span(sorted))), sorted.size()});
}

std::vector<PointTiles::Key> PointTiles::keys() const {
  std::vector<Key> keys;
  for (const auto& [key, chunks] : chunks_) keys.push_back(key);
  return keys;
}

std::vector<TilePoint> PointTiles::read(const Key& key) const {
  std::vector<TilePoint> points;
  for (const Chunk& chunk : chunks_.at(key)) {
    const std::size_t at = points.size();
    points.resize(at + chunk.count);
    file_.read(chunk.offset, std::as_writable_bytes(std::span(points).subspan(at)));
  }
  return points;
}

}  // namespace groundloop
