// Surfaces that several submaps have seen: cells of space whose points lie in a plane, with what
// each submap saw of them as moments. Adaptive: a cell of 2 m where a wall is that flat, down to
// 0.5 m where it is not (as in BALM, Liu and Zhang, RA-L 2021). The two sides of a thin wall are
// two surfaces: a part that was seen from behind is none of it.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "backend/registration/cell_moments.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/voxel_table.hpp"

namespace groundloop {

struct SurfaceCellOptions {
  double finest = 0.5;
  int levels = 3;
  int min_points = 10;
  double max_thickness = 0.15;
  double flatness = 0.1;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("finest", self.finest, Range{0.05, 10.0}, "m", "edge of the smallest cells");
    field("levels", self.levels, Range{1, 8}, "", "sizes of cells, each twice the one before");
    field("min_points", self.min_points, Range{4, 1000}, "", "points that make a surface");
    field("max_thickness", self.max_thickness, Range{0.001, 10.0}, "m",
          "standard deviation across a surface; thicker is none, or two");
    field("flatness", self.flatness, Range{0.001, 1.0}, "",
          "largest deviation across a surface over the smaller one along it");
  }
};

/// What one submap saw of a surface.
struct SurfacePart {
  int submap = 0;
  CellMoments moments;  ///< of its points, in the submap's frame
  /// Sum over the points of the unit vectors from them to the sensor, in the submap's frame.
  Eigen::Vector3d towards_sensor = Eigen::Vector3d::Zero();
};

struct Surface {
  std::vector<SurfacePart> parts;  ///< of two submaps at least, in their order
};

/// The plane of least squares through all parts at the given poses.
struct SurfaceFit {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d deviations = Eigen::Vector3d::Zero();  ///< m: across, then along, ascending
  double points = 0.0;
  [[nodiscard]] double thickness() const { return deviations[0]; }
};
[[nodiscard]] SurfaceFit fit_surface(const std::vector<SurfacePart>& parts,
                                     const std::vector<Pose>& T_world_submap);

/// Collects points submap by submap and gives the surfaces that lie in them. Memory grows with the
/// surface seen, not with the scans.
class SurfaceCells {
 public:
  SurfaceCells(const SurfaceCellOptions& options, std::vector<Pose> T_world_submap);

  /// Points of one scan of a submap. Submaps in ascending order.
  void add(int submap, const Pose& T_submap_scan, const Points& scan);

  /// The surfaces, in an order that depends on the points alone.
  [[nodiscard]] std::vector<Surface> surfaces() const;

 private:
  struct Cell {
    Eigen::Vector3i voxel;
    std::vector<SurfacePart> parts;
  };
  void add_surfaces(const std::vector<const Cell*>& cells, int level,
                    std::vector<Surface>& surfaces) const;

  SurfaceCellOptions options_;
  std::vector<Pose> T_world_submap_;
  VoxelTable index_{1 << 16};
  std::vector<Cell> cells_;
};

}  // namespace groundloop
