// Refines the relative pose of two local maps by point-to-plane ICP, coarse to fine on voxel
// pyramids, with a robust kernel; starts up to about 2 m and 5 degrees away. The Hessian becomes
// the information of the pose, on a scale that counts correlated residuals and drift inside the
// maps. Whether the two maps show the same place at all is not judged here (verification.hpp).
#pragma once

#include <cstddef>
#include <string>

#include "backend/registration/column_agreement.hpp"
#include "backend/registration/voxel_pyramid.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"

namespace groundloop {

struct RegistrationOptions {
  double voxel_size = 0.5;
  int levels = 5;
  int max_iterations = 30;
  double kernel = 0.5;
  int max_points = 250000;
  int max_cells = 20000;
  double heading_starts_deg = 3.0;
  double translation_tolerance = 5e-3;
  double rotation_tolerance_deg = 1e-2;
  double max_translation = 6.0;
  double max_rotation_deg = 10.0;
  int min_inliers = 200;
  double correlated_points = 50.0;
  double translation_floor = 0.05;
  double rotation_floor_deg = 0.1;
  double translation_drift = 0.01;
  double rotation_drift_deg = 0.01;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("voxel_size", self.voxel_size, Range{0.05, 5.0}, "m",
          "cells of the finest level; the grid on which local maps are built");
    field("levels", self.levels, Range{1, 8}, "",
          "each doubles the cells; five reach 8 m, the far end of a map turned by 5 degrees");
    field("max_iterations", self.max_iterations, Range{1, 1000}, "", "of each level");
    field("kernel", self.kernel, Range{0.01, 10.0}, "",
          "scale of the Geman-McClure kernel over the cell size of a level");
    field("max_points", self.max_points, Range{1000, 1e9}, "",
          "of the source that make its cells; a few a cell give the mean");
    field("max_cells", self.max_cells, Range{100, 1e7}, "",
          "of the source in a level's sums; more cost time and no longer help");
    field("heading_starts_deg", self.heading_starts_deg, Range{0.0, 45.0}, "deg",
          "the coarse levels also start turned by this to both sides; 0: only as given");
    field("translation_tolerance", self.translation_tolerance, Range{1e-9, 1.0}, "m",
          "a level ends once steps are shorter, far below what maps allow");
    field("rotation_tolerance_deg", self.rotation_tolerance_deg, Range{1e-9, 10.0}, "deg",
          "and turn less than this");
    field("max_translation", self.max_translation, Range{0.1, 1e3}, "m",
          "a result further from its start is another minimum: not converged");
    field("max_rotation_deg", self.max_rotation_deg, Range{0.1, 180.0}, "deg",
          "likewise, of the rotation");
    field("min_inliers", self.min_inliers, Range{6, 1e7}, "",
          "fewer cells on a surface of the other map cannot hold six unknowns");
    field("correlated_points", self.correlated_points, Range{1.0, 1e6}, "",
          "cells whose residuals share one error (bent maps, moved scans), so count as one");
    field("translation_floor", self.translation_floor, Range{0.0, 10.0}, "m",
          "standard deviation that no number of points goes below, at the overlap");
    field("rotation_floor_deg", self.rotation_floor_deg, Range{0.0, 10.0}, "deg",
          "likewise, of the rotation");
    field("translation_drift", self.translation_drift, Range{0.0, 1.0}, "m/sqrt(m)",
          "drift inside a map on the way from its origin to the overlap, after one metre");
    field("rotation_drift_deg", self.rotation_drift_deg, Range{0.0, 10.0}, "deg/sqrt(m)",
          "likewise, of the rotation; a long map is bent by it");
  }
};

/// A local map to register others to: build once, use for many.
class RegistrationTarget {
 public:
  RegistrationTarget(const Points& points, const RegistrationOptions& options);
  [[nodiscard]] const VoxelPyramid& pyramid() const { return pyramid_; }
  /// Unit vector in the map's frame: the prevailing normal of the surfaces within 60 degrees of z.
  [[nodiscard]] const Eigen::Vector3f& up() const { return up_; }
  [[nodiscard]] const ColumnGrid& columns() const { return columns_; }

 private:
  VoxelPyramid pyramid_;
  Eigen::Vector3f up_;
  ColumnGrid columns_;
};

struct RegistrationResult {
  Pose T_target_source;
  /// Inverse covariance of the error xi of T_true = T_target_source * exp_se3(xi), order
  /// (translation, rotation): weak where the surfaces leave a direction free.
  Matrix6d information = Matrix6d::Zero();
  double rmse = 0.0;        ///< of the inliers' distances to the planes, m
  std::size_t inliers = 0;  ///< source cells on a surface of the target
  int iterations = 0;       ///< of all levels
  bool converged = false;
  std::string failure;  ///< why not converged, one sentence
};

/// `source` and `target` in metres, each in its own frame. Never throws for bad geometry: the
/// result is then not converged.
[[nodiscard]] RegistrationResult register_points(const RegistrationTarget& target,
                                                 const Points& source,
                                                 const Pose& T_target_source_initial,
                                                 const RegistrationOptions& options = {});

}  // namespace groundloop
