#include "tests/fuzz/pipeline.hpp"

#include <algorithm>
#include <cmath>

#include "frontend/core/error.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/odometry.hpp"
#include "frontend/recordings/fingerprint.hpp"
#include "loopclosure/describe.hpp"
#include "loopclosure/loop_database.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace groundloop::fuzz {

namespace {

constexpr std::size_t kMostScans = 6;
constexpr float kLongestScan = 3600.0F;  // s

// Few points and small maps, so that short inputs get through.
OdometryOptions odometry_options() {
  OdometryOptions options;
  options.min_points = 3;
  options.max_iterations = 20;
  return options;
}

LocalMapOptions map_options() {
  LocalMapOptions options;
  options.max_scans = 3;
  return options;
}

bool finite(const Pose& pose) {
  return pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1.0) < 1e-6;
}

void describe(const LocalMap& map, LoopDatabase& database) {
  for (const Eigen::Vector3f& p : map.points) FUZZ_PROMISE(p.allFinite());
  MapDescription description = describe_map({0, map.id}, map.points, {});
  FUZZ_PROMISE(finite(description.T_ground_map));
  (void)database.query(description);
  database.insert(std::move(description));
}

}  // namespace

void expect_sound(const Scan& scan) {
  FUZZ_PROMISE(is_stamp(scan.stamp));
  FUZZ_PROMISE(scan.times.empty() || scan.times.size() == scan.points.size());
  for (const Eigen::Vector3f& p : scan.points)
    FUZZ_PROMISE(p.allFinite() && std::isfinite(p.squaredNorm()) && !p.isZero(0.0F));
  for (const float t : scan.times) FUZZ_PROMISE(std::abs(t) <= kLongestScan);
}

void process(const std::vector<Scan>& scans) {
  Odometry odometry(odometry_options());
  LocalMapBuilder builder(map_options());
  LoopDatabase database{LoopClosureOptions{}};
  const auto refused = [](auto&& work) {
    try {
      work();
      return false;
    } catch (const InputError&) {
      return true;
    }
  };
  if (scans.size() > 1) (void)refused([&] { odometry.start(scans[0], scans[1]); });
  for (const Scan& scan : scans) {
    std::optional<LocalMap> map;
    const bool left_out = refused([&] {
      const RegisteredScan registered = odometry.add(scan, "scan");
      FUZZ_PROMISE(finite(registered.T_world_scan));
      map = builder.add(registered.points, registered.T_world_scan);
    });
    if (!left_out && map) describe(*map, database);
  }
  if (const std::optional<LocalMap> map = builder.finish()) describe(*map, database);
}

void use(Recording& recording) {
  FUZZ_PROMISE(recording.size() > 0);
  for (std::size_t i = 0; i < recording.size(); ++i) {
    FUZZ_PROMISE(is_stamp(recording.stamp(i)));
    FUZZ_PROMISE(i == 0 || recording.stamp(i - 1) < recording.stamp(i));
  }
  for (const StampedPose& sample : recording.ground_truth()) {
    FUZZ_PROMISE(is_stamp(sample.stamp));
    FUZZ_PROMISE(finite(sample.pose));
  }
  (void)recording_fingerprint(recording);
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < std::min(recording.size(), kMostScans); ++i) {
    try {
      scans.push_back(recording.read(i));
      expect_sound(scans.back());
      FUZZ_PROMISE(!scans.back().points.empty());
    } catch (const InputError&) {
    }
  }
  process(scans);
}

}  // namespace groundloop::fuzz
