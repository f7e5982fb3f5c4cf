// Poses of submaps adjusted so that surfaces seen by many of them become thin, with what the pose
// graph knows as the prior: bundle adjustment of planes, their parameters eliminated (BALM2, Liu et
// al., T-RO 2023, who minimise the same smallest eigenvalue; here by Gauss-Newton on the square
// roots of the moments, Schur complement per surface).
//
// The residual of what submap k saw of a surface with plane (n, d), n'x + d = 0 in the world, is
// L_k' T_k' (n, d): four numbers whose squares sum to the mean square distance of its points from
// the plane, weighted by 1 / (point_deviation^2 / points + submap_deviation^2). Perturbations are
// on the right, translation first: T exp(xi).
#pragma once

#include <cstddef>
#include <vector>

#include "backend/refinement/surface_cells.hpp"
#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"

namespace groundloop {

struct SurfaceAdjustmentOptions {
  double point_deviation = 0.03;
  double submap_deviation = 0.01;
  double kernel = 3.0;
  int max_iterations = 20;
  double convergence_m = 1e-4;
  double convergence_rad = 1e-5;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("point_deviation", self.point_deviation, Range{1e-4, 1.0}, "m",
          "of one point from its surface: noise of a LiDAR and roughness of walls");
    field("submap_deviation", self.submap_deviation, Range{1e-4, 1.0}, "m",
          "of all points of a submap alike: calibration, bending within it; what more points do "
          "not mend");
    field("kernel", self.kernel, Range{0.1, 100.0}, "",
          "Cauchy scale in standard deviations: a part this far off is half believed");
    field("max_iterations", self.max_iterations, Range{1, 1000}, "", "");
    field("convergence_m", self.convergence_m, Range{1e-9, 1.0}, "m",
          "largest step of a submap that ends the adjustment");
    field("convergence_rad", self.convergence_rad, Range{1e-9, 1.0}, "rad", "the same in rotation");
  }
};

/// What is known beforehand of two submaps: T_from_to with its information, translation first.
struct RelativePrior {
  int from = 0, to = 0;
  Pose T_from_to;
  Matrix6d information = Matrix6d::Zero();
};

struct SurfaceAdjustment {
  std::vector<Pose> T_world_submap;
  int iterations = 0;
  bool converged = false;
  double cost_before = 0.0, cost_after = 0.0;    ///< surfaces and priors, robust
  double prior_before = 0.0, prior_after = 0.0;  ///< half the squared priors
  /// Largest squared Mahalanobis distance of a prior, of six degrees of freedom.
  double worst_prior = 0.0;
};

/// Adjusts all poses but that of submap `fixed`. Surfaces name submaps by their place in
/// `T_world_submap`. Deterministic for any number of threads. Throws std::logic_error where a
/// surface or prior names a submap that does not exist.
[[nodiscard]] SurfaceAdjustment adjust_surfaces(const std::vector<Surface>& surfaces,
                                                const std::vector<RelativePrior>& priors,
                                                std::vector<Pose> T_world_submap, int fixed,
                                                const SurfaceAdjustmentOptions& options);

/// The gradient and the Gauss-Newton matrix of the surfaces' cost at given poses, dense, six rows a
/// submap: for tests against finite differences.
struct SurfaceNormalEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double cost = 0.0;
};
[[nodiscard]] SurfaceNormalEquations surface_normal_equations(
    const std::vector<Surface>& surfaces, const std::vector<Pose>& T_world_submap,
    const SurfaceAdjustmentOptions& options);

/// Mean thickness of surfaces at given poses, m, and the thickness that 95 % stay below.
struct SurfaceThickness {
  double mean = 0.0, most = 0.0;
  std::size_t surfaces = 0;
};
[[nodiscard]] SurfaceThickness thickness_of(const std::vector<Surface>& surfaces,
                                            const std::vector<Pose>& T_world_submap);

}  // namespace groundloop
