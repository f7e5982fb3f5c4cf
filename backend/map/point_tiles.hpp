// Points of a whole map sorted into square tiles on disk, so that memory holds one tile at a time,
// however long the recording: what map assembly, export and evaluation go through. The file has no
// name and is gone with the object, however the process ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/output_file.hpp"

namespace groundloop {

/// A point of a tile: metres from the tile's corner, and what the caller knows it by.
struct TilePoint {
  Eigen::Vector3f offset;
  std::uint32_t tag = 0;
};

class PointTiles {
 public:
  struct Key {
    std::int32_t x = 0, y = 0;
    friend auto operator<=>(const Key&, const Key&) = default;
  };

  /// Tiles of `edge` metres; their file is in `folder`. Throws InputError where it cannot be
  /// written.
  PointTiles(const std::filesystem::path& folder, double edge);

  /// Sorts points of the world into tiles; those that are not finite, or further off than any map,
  /// are left out.
  void add(std::span<const Eigen::Vector3d> points, std::uint32_t tag);

  /// In ascending order.
  [[nodiscard]] std::vector<Key> keys() const;
  [[nodiscard]] std::vector<TilePoint> read(const Key& key) const;
  [[nodiscard]] Eigen::Vector3d corner(const Key& key) const {
    return {key.x * edge_, key.y * edge_, 0.0};
  }

 private:
  struct Chunk {
    std::uint64_t offset;  // bytes
    std::uint64_t count;   // points
  };

  double edge_;
  ScratchFile file_;
  std::map<Key, std::vector<Chunk>> chunks_;
};

}  // namespace groundloop
