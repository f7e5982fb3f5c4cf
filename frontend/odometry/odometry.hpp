// LiDAR odometry: KISS-ICP (Vizzo et al., RA-L 2023), which the paper uses to build local maps
// (Sec. 3.1).
//
// Scan by scan: predict with constant velocity, deskew, downsample, register against a voxel map
// with an adaptive threshold and a robust kernel, update the map. Poses are those of the instant
// that the scan's stamp names; inside, points are brought to the middle of the sweep, where an
// error of the predicted velocity does least harm.
//
// Where the sensor swings (in a hand, on a balancing carrier) the velocity of the last step is an
// old one: half a degree to a degree off at the ends of a sweep. Such a scan is registered again
// with its turn over the sweep as a further unknown, and deskewed by what was found.
//
// A scan that fits the map poorly is registered again from other starts (pose_search.hpp); one that
// cannot be registered is predicted.
//
// Unlike KISS-ICP, which registers points to points, points are registered to the planes of the
// map, and what has no plane counts little: the nearest neighbours of scan lines are scan lines,
// and pull the pose along the ground and walls that they cross (16 beams without any noise: 1.4 %
// of drift, 0.25 % on planes). A first registration, points in full, catches a poor prediction.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>

#include "frontend/core/options.hpp"
#include "frontend/core/pose.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/odometry/adaptive_threshold.hpp"
#include "frontend/odometry/odometry_quality.hpp"
#include "frontend/odometry/pose_search.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/odometry/scan_registration.hpp"
#include "frontend/odometry/voxel_map.hpp"

namespace groundloop {

struct OdometryOptions {
  double max_range = 100.0;
  double min_range = 0.0;
  double voxel_size = 1.0;
  double initial_threshold = 2.0;
  double min_motion = 0.1;
  int max_iterations = 500;
  double stop_translation = 5e-4;
  double stop_rotation_deg = 0.005;
  int min_points = 30;
  double max_gap = 1.0;
  bool point_to_point = false;
  double along_plane_weight = 0.01;
  double scatter_weight = 0.1;
  double fine_threshold = 0.2;
  double blocked_share = 0.1;
  int max_blocked = 20;
  double swing_deg = 0.3;
  bool second_registration = true;
  double search_scale = 5.0;
  double search_turn_deg = 8.0;
  double search_poor = 1.11;
  double search_better = 1.1;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("max_range", self.max_range, Range{1.0, 1000.0}, "m",
          "farther points are left out of odometry and maps");
    field("min_range", self.min_range, Range{0.0, 100.0}, "m",
          "nearer points are left out, e.g. those of the vehicle");
    field("voxel_size", self.voxel_size, Range{0.05, 10.0}, "m",
          "voxels of the odometry map; max_range / 100 suits most places, less indoors");
    field("initial_threshold", self.initial_threshold, Range{0.01, 50.0}, "m",
          "scale of the registration before any motion was seen");
    field("min_motion", self.min_motion, Range{1e-4, 10.0}, "m",
          "smaller departures from the prediction do not adapt the threshold");
    field("max_iterations", self.max_iterations, Range{1, 10000}, "", "of one registration");
    field("stop_translation", self.stop_translation, Range{1e-9, 1.0}, "m",
          "an update that moves the sensor by less, and turns it by less than stop_rotation_deg, "
          "ends a registration");
    field("stop_rotation_deg", self.stop_rotation_deg, Range{1e-9, 10.0}, "degrees",
          "0.005 degrees are 4 mm at 50 m");
    field("min_points", self.min_points, Range{3, 100000}, "",
          "points within range that a scan must have to be registered; the pose of one with fewer "
          "is predicted");
    field("max_gap", self.max_gap, Range{0.01, 3600.0}, "s",
          "a longer step in time is a gap: the velocity is trusted for this long only");
    field("point_to_point", self.point_to_point, OnOff{}, "",
          "KISS-ICP's own residual; off, planes of the map are used where it has them");
    field("along_plane_weight", self.along_plane_weight, Range{0.0, 1.0}, "",
          "weight of a residual along a plane, against 1 across it");
    field("scatter_weight", self.scatter_weight, Range{0.001, 1.0}, "",
          "weight of a point without a plane in the second registration, against 1 across a plane");
    field(
        "fine_threshold", self.fine_threshold, Range{0.01, 10.0}, "voxel_size",
        "kernel scale of the second registration, over denser points: the adaptive scale takes in "
        "the error of the prediction, which a converged scan no longer has");
    field("blocked_share", self.blocked_share, Range{0.0, 0.9}, "",
          "a scan that fills fewer voxels than this share of the usual sees what stands before the "
          "sensor, not the place: its pose is predicted");
    field("max_blocked", self.max_blocked, Range{0, 100000}, "",
          "scans in a row whose pose may be predicted; then they are registered all the same");
    field(
        "swing_deg", self.swing_deg, Range{0.0, 180.0}, "degrees",
        "a turning rate that changes by more, from one scan to the next and over half a sweep, is "
        "that of a sensor that swings: its turn is measured within the sweep too");
    field("second_registration", self.second_registration, OnOff{}, "",
          "off, the first registration is the last, as in KISS-ICP");
    field("search_scale", self.search_scale, Range{0.0, 100.0}, "voxel_size",
          "voxels of the wide map that a scan is brought near by where it fits the map poorly; 0: "
          "only constant velocity leads, as in KISS-ICP");
    field("search_turn_deg", self.search_turn_deg, Range{0.0, 90.0}, "degrees",
          "turns of the last pose that are tried where the wide map does not do; 0: none");
    field("search_poor", self.search_poor, Range{1.0, 100.0}, "",
          "a registered scan that lies this many times as far from the map as usual fits poorly: "
          "other starts are tried");
    field("search_better", self.search_better, Range{1.0, 100.0}, "",
          "by so much the outcome of another start must be nearer to the map to be taken");
  }
};

struct RegisteredScan {
  Pose T_world_scan;  ///< at the scan's stamp
  Points points;      ///< within range, deskewed to the stamp's instant, scan frame; none where the
                      ///< pose was predicted
  bool predicted = false;  ///< not registered: few points, or a blocked view
  ScanQuality quality;     ///< how well it went, and in which state odometry is
  std::size_t registration_points = 0;
  int iterations = 0;
  double seconds = 0.0;  ///< busy time of this scan
};

class Odometry {
 public:
  explicit Odometry(const OdometryOptions& options);

  /// Before the first add(): learns the velocity at the start from the first two scans, so that the
  /// first is deskewed too and `world` is its frame at its stamp. Without it the sensor is taken to
  /// stand still at first.
  void start(const Scan& first, const Scan& second);

  /// Registers the next scan. One with too few points (none, all NaN, fewer than min_points within
  /// range) is predicted, with a warning for the first in a row; `name` stands for the scan there.
  RegisteredScan add(const Scan& scan, const std::string& name);

  /// Of `values`, one a point of `scan` or none, those of the points that a RegisteredScan has.
  [[nodiscard]] std::vector<float> within_range(const Scan& scan,
                                                const std::vector<float>& values) const {
    return values_within(scan, values, options_.min_range, options_.max_range);
  }

  /// Whether any scan was registered so far, or began the map.
  [[nodiscard]] bool started() const { return scans_ > 0; }

  /// Scans that had too few points or a blocked view, and whose pose was predicted.
  [[nodiscard]] std::size_t predicted_scans() const { return predicted_scans_; }

  /// Exact state for a resumable session.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  // When the points of a scan were measured, s from its stamp.
  struct Sweep {
    double middle = 0.0;
    double half = 0.0;  // from the middle to either end
  };
  static Sweep sweep_of(const Scan& scan);
  // At the middle of the sweep.
  struct DeskewedScan {
    Points points;      // within range
    Points map_points;  // of those, what the map gets
  };
  [[nodiscard]] DeskewedScan deskew(const Scan& scan, const SensorMotion& motion, double middle);
  [[nodiscard]] RegistrationKernel coarse_kernel() const;
  [[nodiscard]] RegistrationKernel fine_kernel() const;
  [[nodiscard]] std::size_t points_within_range(const Scan& scan) const;
  [[nodiscard]] bool blocked(std::size_t voxels);
  // Whether a scan of so many points, which fill so many voxels, cannot be registered.
  [[nodiscard]] bool poor(std::size_t points, std::size_t voxels, const std::string& name);
  RegisteredScan predicted(const Pose& guess, const Sweep& sweep, double step);
  [[nodiscard]] PoseSearch::Found register_to_map(const SweepPoints& source,
                                                  const SweepPoints& fine_source,
                                                  const Points& map_points, const Pose& guess,
                                                  const std::vector<Pose>& others);
  // Where the sensor may be beside the guess: after its last step once more, however long it took;
  // where it was; and where its velocity leads through a gap.
  [[nodiscard]] std::vector<Pose> other_predictions(double step) const;
  [[nodiscard]] ScanQuality judge(const PoseSearch::Found& found, const Points& points,
                                  const Pose& guess, const std::vector<Pose>& others, double step);
  void learn_deviation(const Pose& guess, const Pose& registered);
  // Whether the sensor swings, now that its mean velocity since the last scan is `velocity`.
  [[nodiscard]] bool swings(const Sweep& sweep, const Vector6d& velocity);
  // Registers a scan of a sensor that swings, from where it is registered on, and deskews it anew.
  // Returns how the sensor moved about the middle of the sweep.
  SensorMotion measure_swing(const Scan& scan, const Sweep& sweep, DeskewedScan& deskewed,
                             double step, ScanRegistration& registration);
  void insert(const Points& map_points);

  OdometryOptions options_;
  VoxelMap map_;
  PoseSearch search_;
  OdometryJudge judge_;
  AdaptiveThreshold threshold_;
  VoxelDownsampler downsampler_;
  // The pose and velocity of the last scan, at the middle of its sweep.
  Pose T_world_middle_;
  Nanoseconds middle_stamp_ = 0;
  Vector6d twist_ = Vector6d::Zero();      // m/s, rad/s
  Vector6d last_step_ = Vector6d::Zero();  // between the last two scans, however long it took
  // Of the last sweep as it tells itself, rad/s, if it was asked.
  std::optional<Eigen::Vector3d> turn_rate_;
  int swinging_ = 0;  // scans that the sensor is taken to swing on for
  std::size_t scans_ = 0;
  double usual_voxels_ = 0.0;  // that a scan fills
  int blocked_ = 0;            // scans in a row until now
  int few_ = 0;                // likewise, of too few points
  std::size_t predicted_scans_ = 0;
  Eigen::Vector3d pruned_at_ = Eigen::Vector3d::Zero();
};

}  // namespace groundloop
