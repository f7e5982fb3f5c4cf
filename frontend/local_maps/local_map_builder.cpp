#include "frontend/local_maps/local_map_builder.hpp"

#include "frontend/core/binary_io.hpp"

namespace groundloop {

LocalMapBuilder::LocalMapBuilder(const LocalMapOptions& options, int first_id)
    : options_(options), id_(first_id) {}

std::optional<LocalMap> LocalMapBuilder::add(const Points& points, const Pose& T_world_scan) {
  if (scan_ == first_scan_) {
    T_world_map_ = T_world_scan;
    last_position_ = T_world_scan.translation;
    path_ = 0.0;
  }
  const PoseF T_map_scan(T_world_map_.inverse() * T_world_scan);
  const auto inverse_size = static_cast<float>(1.0 / options_.voxel_size);
  const auto limit = static_cast<std::uint32_t>(options_.max_points_per_voxel);
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = T_map_scan * point;
    const auto fresh = static_cast<std::uint32_t>(blocks_.size());
    const VoxelKey key = voxel_key(voxel_of(p, inverse_size));
    const std::uint32_t index = table_.find_or_insert(key, fresh);
    if (index == fresh) blocks_.emplace_back().key = key;
    Block& block = blocks_[index];
    if (block.count < limit) block.points[block.count++] = p;
  }
  path_ += (T_world_scan.translation - last_position_).norm();
  last_position_ = T_world_scan.translation;
  ++scan_;
  const double displacement = (T_world_scan.translation - T_world_map_.translation).norm();
  const bool complete = displacement > options_.length || path_ > options_.max_path ||
                        scan_ - first_scan_ >= static_cast<std::size_t>(options_.max_scans);
  if (!complete) return std::nullopt;
  return take();
}

std::optional<LocalMap> LocalMapBuilder::finish() {
  if (scan_ == first_scan_) return std::nullopt;
  return take();
}

void LocalMapBuilder::save(std::ostream& out) const {
  put(out, id_);
  put(out, scan_);
  put(out, first_scan_);
  put(out, T_world_map_);
  put(out, last_position_);
  put(out, path_);
  put_all(out, blocks_);
}

void LocalMapBuilder::load(std::istream& in) {
  get(in, id_);
  get(in, scan_);
  get(in, first_scan_);
  get(in, T_world_map_);
  get(in, last_position_);
  get(in, path_);
  get_all(in, blocks_);
  for (const Block& block : blocks_) {
    if (block.count > block.points.size()) in.setstate(std::ios::failbit);
  }
  table_.clear();
  for (std::uint32_t i = 0; i < blocks_.size(); ++i) table_.find_or_insert(blocks_[i].key, i);
}

LocalMap LocalMapBuilder::take() {
  LocalMap map;
  map.id = id_++;
  map.first_scan = first_scan_;
  map.last_scan = scan_ - 1;
  map.T_world_map = T_world_map_;
  std::size_t count = 0;
  for (const Block& block : blocks_) count += block.count;
  map.points.reserve(count);
  for (const Block& block : blocks_) {
    map.points.insert(map.points.end(), block.points.begin(), block.points.begin() + block.count);
  }
  blocks_.clear();
  table_.clear();
  first_scan_ = scan_;
  return map;
}

}  // namespace groundloop
