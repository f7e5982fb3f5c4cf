// Builds local maps from registered scans (Sec. 3.1): consecutive scans until the displacement from
// the first exceeds a length, in voxels that keep a bounded number of points. Maps partition the
// scans. A map also ends after a bound on the path or on scans, so that one who circles in place
// still finishes maps, in bounded memory.
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <vector>

#include "frontend/core/options.hpp"
#include "frontend/core/voxel_table.hpp"
#include "frontend/local_maps/local_map.hpp"

namespace groundloop {

struct LocalMapOptions {
  double length = 100.0;
  double max_path = 300.0;
  int max_scans = 5000;
  double voxel_size = 0.5;
  int max_points_per_voxel = 20;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("length", self.length, Range{1.0, 10000.0}, "m",
          "displacement from its first scan that ends a local map");
    field("max_path", self.max_path, Range{1.0, 100000.0}, "m",
          "path that ends a map all the same, for those who circle in place");
    field("max_scans", self.max_scans, Range{2, 1000000}, "", "scans that end a map all the same");
    field("voxel_size", self.voxel_size, Range{0.05, 10.0}, "m", "voxels of a local map");
    field("max_points_per_voxel", self.max_points_per_voxel, Range{1, 20}, "",
          "points kept in a voxel, the first ones");
  }
};

class LocalMapBuilder {
 public:
  explicit LocalMapBuilder(const LocalMapOptions& options, int first_id = 0);

  /// Adds a scan (points in the scan frame). Returns the map that this scan completes, if it
  /// completes one.
  std::optional<LocalMap> add(const Points& points, const Pose& T_world_scan);

  /// The last, unfinished map; none where no scan was added since the last finished one.
  std::optional<LocalMap> finish();

  /// Exact state for a resumable session.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  static constexpr std::size_t kCapacity = 20;
  struct Block {
    std::array<Eigen::Vector3f, kCapacity> points;
    VoxelKey key = 0;
    std::uint32_t count = 0;
  };

  LocalMap take();

  LocalMapOptions options_;
  int id_;
  std::size_t scan_ = 0;  // number of the next scan
  std::size_t first_scan_ = 0;
  Pose T_world_map_;
  Eigen::Vector3d last_position_ = Eigen::Vector3d::Zero();
  double path_ = 0.0;
  VoxelTable table_{1 << 16};
  std::vector<Block> blocks_;
};

}  // namespace groundloop
