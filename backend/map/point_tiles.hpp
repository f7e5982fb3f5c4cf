// Points of a whole map sorted into square tiles on disk, so that memory holds one tile at a time,
// however long the recording: what map assembly, export and evaluation go through. The file has no
// name and is gone with the object, however the process ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "frontend/core/output_file.hpp"

namespace groundloop {

/// A point of a map.
struct WorldPoint {
  Eigen::Vector3d position;  ///< world, m
  float intensity = 0.0F;    ///< 0 where the recording has none
  std::uint32_t tag = 0;     ///< what the caller knows it by
};

/// The same in a tile.
struct TilePoint {
  Eigen::Vector3f offset;  ///< from the tile's corner, m
  float intensity = 0.0F;
  float weight = 1.0F;  ///< points that it stands for
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

  using Sorted = std::map<Key, std::vector<TilePoint>>;
  /// Points of the world sorted into tiles; those that are not finite, or further off than any map,
  /// are left out. Writes nothing: may be called from several threads.
  [[nodiscard]] Sorted sort(std::span<const WorldPoint> points) const;
  void append(const Sorted& points);
  void add(std::span<const WorldPoint> points) { append(sort(points)); }

  /// In ascending order.
  [[nodiscard]] std::vector<Key> keys() const;
  /// Calls f for the points of a tile in the order they were added, as many at a time as came
  /// together. May be called from several threads.
  void for_each_chunk(const Key& key,
                      const std::function<void(std::span<const TilePoint>)>& f) const;
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
