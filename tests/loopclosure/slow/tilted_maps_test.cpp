// The paper's Fig. 14 on simulated maps: local maps of several sensors, turned by 10 to 80 degrees
// about ten horizontal axes.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "loopclosure/ground_alignment.hpp"

namespace groundloop {
namespace {

// A local map of every fifth scan at true poses, over about 60 m.
Points true_map(const std::string& sensor) {
  const auto recording = open_any_recording("sim:town?sensor=" + sensor + "&length=60&seed=3");
  const Trajectory truth = recording->ground_truth();
  LocalMapBuilder builder(LocalMapOptions{});
  for (std::size_t i = 0; i < recording->size(); i += 5) {
    const Points points = deskew_and_crop(recording->read(i), {}, 0.0, 0.0, 100.0);
    (void)builder.add(points, truth.at(i).pose);
  }
  const auto map = builder.finish();
  return map ? map->points : Points{};
}

class TiltedMaps : public ::testing::TestWithParam<const char*> {};

TEST_P(TiltedMaps, AreLaidLevelWhateverTheirTilt) {
  const Points points = true_map(GetParam());
  ASSERT_GT(points.size(), 1000U);
  const GroundAlignment level = align_to_ground(points, {});
  ASSERT_TRUE(level.found);
  const Eigen::Vector3d up = level.T_ground_map.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  // The car stands on its wheels: the street is level to within its slope.
  EXPECT_LT(std::acos(up.z()) * 180 / M_PI, 8.0);
  for (int degrees = 10; degrees <= 80; degrees += 10) {
    double mean = 0.0;
    for (int axis = 0; axis < 10; ++axis) {
      const double direction = 2 * M_PI * axis / 10;
      const Pose tilt(exp_so3(Eigen::Vector3d(std::cos(direction), std::sin(direction), 0) *
                              degrees * M_PI / 180),
                      Eigen::Vector3d::Zero());
      const PoseF transform(tilt);
      Points tilted;
      tilted.reserve(points.size());
      for (const Eigen::Vector3f& p : points) tilted.push_back(transform * p);
      const Pose T = align_to_ground(tilted, {}).T_ground_map * tilt;
      const Eigen::Vector3d found = T.rotation.conjugate() * Eigen::Vector3d::UnitZ();
      mean += std::acos(std::min(1.0, found.dot(up))) * 180 / M_PI / 10;
    }
    EXPECT_LT(mean, degrees <= 60 ? 1.0 : 10.0) << degrees << " degrees";
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, TiltedMaps,
                         ::testing::Values("spin32", "spin64", "spin128", "raster", "rosette"));

}  // namespace
}  // namespace groundloop
