// How sure odometry is of itself: a stated drift model that gives each step a covariance. Drift is
// a random walk in translation and rotation, so that variances grow with the way gone and turned,
// and are carried through composition by the adjoint; what a small error of heading does to the
// position a kilometre later follows from that. It is a model, not a measurement: a degenerate
// scene (a tunnel) is not seen by it. How true it is of a recording is found from its closures
// (odometry_scale.hpp).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "backend/graph/relative_pose.hpp"
#include "frontend/core/options.hpp"

namespace groundloop {

/// With the defaults a step of 1 m is certain to 3 cm and 0.03 degrees; the position after 100 m,
/// 1 km and 4 km along a straight line to 0.4, 9 and 73 m (0.4, 0.9 and 1.8 % of the way).
struct OdometryInformationOptions {
  double translation = 0.03;
  double rotation = 5e-4;
  double rotation_per_turn = 2e-3;
  double translation_floor = 1e-3;
  double rotation_floor = 2e-5;
  bool estimate_scale = true;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("translation", self.translation, Range{1e-6, 10.0}, "m/sqrt(m)",
          "standard deviation of the position after one metre; registration to a map of 0.5 m "
          "voxels is good to about 3 cm");
    field(
        "rotation", self.rotation, Range{1e-8, 1.0}, "rad/sqrt(m)",
        "standard deviation of the heading after one metre; 0.29 degrees after 100 m lies between "
        "what dense scans (0.2) and the thinned ones of the real drive (0.4) show");
    field("rotation_per_turn", self.rotation_per_turn, Range{0.0, 1.0}, "rad/sqrt(rad)",
          "the same after one radian turned; fast turns deskew worse and see new scenery");
    field("translation_floor", self.translation_floor, Range{1e-6, 10.0}, "m",
          "of every step, also at rest: keeps information finite");
    field("rotation_floor", self.rotation_floor, Range{1e-8, 1.0}, "rad",
          "of every step, also at rest: keeps information finite");
    field("estimate_scale", self.estimate_scale, OnOff{}, "",
          "multiply the above by what the closures of the recording say; sensors and scenes differ "
          "by a factor of ten");
  }
};

/// Standard deviations times `scale`.
[[nodiscard]] OdometryInformationOptions scaled(OdometryInformationOptions options, double scale);

/// Covariance of one odometry step T_previous_current, perturbation on the right.
[[nodiscard]] Matrix6d odometry_covariance(const Pose& T_previous_current,
                                           const OdometryInformationOptions& options);
/// Its inverse.
[[nodiscard]] Matrix6d odometry_information(const Pose& T_previous_current,
                                            const OdometryInformationOptions& options);

/// Relative pose of scan `to` in scan `from` (from <= to) along the odometry `T_world_scan`, with
/// the covariance of all the steps between. For key-pose edges: information is its inverse.
/// `loose`: variances that the step to each scan has beside those; none where it is empty.
[[nodiscard]] RelativePose compose_odometry(std::span<const Pose> T_world_scan, std::size_t from,
                                            std::size_t to,
                                            const OdometryInformationOptions& options,
                                            std::span<const Vector6d> loose = {});

/// The same for any two scans in constant time, in either direction, from sums kept once.
class OdometryChain {
 public:
  OdometryChain(std::span<const Pose> T_world_scan, const OdometryInformationOptions& options);
  /// Pose of scan `to` in scan `from`; `from` may be greater than `to`.
  [[nodiscard]] RelativePose between(std::size_t from, std::size_t to) const;

 private:
  std::vector<Pose> T_first_scan_;
  std::vector<Matrix6d> covariance_;  // of scan i in the first, perturbed in the first's frame
};

}  // namespace groundloop
