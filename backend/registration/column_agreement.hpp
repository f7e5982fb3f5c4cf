// Whether two local maps agree on where tall things stand. The space is cut into upright columns of
// 1 m; in each, a map is tall (facade, trunk, car) or flat (road, lawn). The correlation of the two
// maps over the columns both have seen tells one street from another, which overlap cannot: ground
// covers ground anywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {

struct ColumnAgreement {
  /// Phi coefficient of tall against flat, in [-1, 1]; 0 where it is not defined.
  double correlation = 0.0;
  std::size_t shared = 0;  ///< columns seen by both
  /// False where the shared columns are nearly all tall or all flat (tunnel, field): nothing to
  /// correlate.
  bool defined = false;
};

/// The agreement where the maps were put, against that of places beside: another LiDAR, or years,
/// lower all of them alike, and a true place stands out still.
struct ColumnContrast {
  double here = 0.0;
  double beside = 0.0;   ///< the highest where one map is moved by 4 to 20 m
  bool defined = false;  ///< false where the agreement here is not
  [[nodiscard]] double margin() const { return here - beside; }
};

class ColumnGrid {
 public:
  /// Columns along `up` (unit vector, map frame) of `T_map_points * points`.
  ColumnGrid(const Points& points, const Pose& T_map_points, const Eigen::Vector3f& up);

  /// Both grids in the same frame and with the same `up`.
  [[nodiscard]] ColumnAgreement agreement(const ColumnGrid& other) const;
  [[nodiscard]] ColumnContrast contrast(const ColumnGrid& other) const;

 private:
  struct Column {
    VoxelKey key = 0;
    float low = 0.0F;
    float high = 0.0F;
    std::uint32_t points = 0;
    [[nodiscard]] bool tall() const;
    [[nodiscard]] bool seen() const;
  };
  /// Cell and whether it is tall.
  [[nodiscard]] std::vector<std::pair<Eigen::Vector2i, bool>> seen_columns() const;

  VoxelTable index_;
  std::vector<Column> columns_;
};

}  // namespace groundloop
