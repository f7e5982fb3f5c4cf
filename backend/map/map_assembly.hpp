// The map of one or several sessions from scans or local maps on disk and their optimised poses, a
// few files in memory at a time. Points of a voxel become their mean, over all scans that see it:
// the means of each file are sorted into tiles in a temporary file first, so that memory holds the
// voxels of a few tiles, however long the recording. The bytes are the same for any number of
// threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "backend/map/map_piece.hpp"
#include "backend/map/point_cloud_export.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop {

struct MapAssemblyOptions {
  double voxel_size = 0.1;
  double tile_size = 50.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("voxel_size", self.voxel_size, Range{0.0, 100.0}, "m",
          "one point a voxel, the mean; 0 keeps every point of the scans or local maps");
    field("tile_size", self.tile_size, Range{1.0, 10000.0}, "m",
          "edge of the square that is in memory at a time");
  }
};

/// The fields that the map of these pieces can have.
[[nodiscard]] ExportFields fields_of(const std::vector<MapPiece>& pieces, bool session);

/// Writes the map to `writer` (finish() is the caller's) and returns its number of points. The
/// order is that of the tiles, not of the pieces. `folder` takes the temporary file.
std::uint64_t assemble_map(const std::vector<MapPiece>& pieces, const MapAssemblyOptions& options,
                           PointCloudWriter& writer, const std::filesystem::path& folder,
                           const Progress& progress = {});

}  // namespace groundloop
