#include "backend/mapping/revisit_check.hpp"

#include <gtest/gtest.h>

#include "tests/support/street_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

Pose at(double x, double y) {
  Pose pose;
  pose.translation = {x, y, 0.0};
  return pose;
}

// Six maps; the last sees the street of the first again, the others are far away.
class RevisitCheck : public ::testing::Test {
 protected:
  RevisitCheck() {
    std::filesystem::create_directories(folder_ / "local_maps");
    const testing::StreetScene scene(1);
    for (int i = 0; i < 6; ++i) {
      LocalMap map;
      map.id = i;
      map.points = scene.sample(60000, 0.02, static_cast<unsigned>(i + 1));
      store_.put(map);
      footprints_.push_back(ground_footprint(map.points));
      true_poses_.push_back(at(0.0, i == 5 ? 0.0 : 1000.0 * i));
    }
  }

  [[nodiscard]] MapQuality compare(const std::vector<Pose>& before, const std::vector<Pose>& after,
                                   const MapQualityOptions& options = {}) {
    const auto between = [](const std::vector<Pose>& poses) -> RelativePoses {
      return
          [&poses](int reference, int query) { return poses[query].inverse() * poses[reference]; };
    };
    return compare_revisits(footprints_, between(before), between(after), store_, options);
  }
  [[nodiscard]] std::vector<Pose> last_at(double x, double y) const {
    std::vector<Pose> poses = true_poses_;
    poses.back() = at(x, y);
    return poses;
  }

  testing::TemporaryFolder folder_;
  MapStore store_{SessionFolder(folder_.path()), {}};
  std::vector<GroundFootprint> footprints_;
  std::vector<Pose> true_poses_;
};

TEST_F(RevisitCheck, ATrueSolutionIsSharper) {
  const MapQuality quality = compare(last_at(1.0, 1.5), true_poses_);
  EXPECT_EQ(quality.pairs, 1u);
  EXPECT_LT(quality.after.plane_thickness, quality.before.plane_thickness);
  EXPECT_FALSE(quality.worse);
}

TEST_F(RevisitCheck, APlaceTornApartIsWorse) {
  // In the solution the maps share nothing: no surface is then missed, and yet it is no gain.
  for (const double y : {1.5, 500.0}) {
    const MapQuality quality = compare(true_poses_, last_at(1.0, y));
    EXPECT_EQ(quality.pairs, 1u);
    EXPECT_GT(quality.after.plane_thickness, quality.before.plane_thickness);
    EXPECT_TRUE(quality.worse);
  }
}

TEST_F(RevisitCheck, EqualPosesAreNotWorse) {
  const MapQuality quality = compare(true_poses_, true_poses_);
  EXPECT_EQ(quality.after.plane_thickness, quality.before.plane_thickness);
  EXPECT_FALSE(quality.worse);
}

TEST_F(RevisitCheck, WithoutRevisitsThereIsNothingToSay) {
  const std::vector<Pose> apart = last_at(0.0, 5000.0);
  EXPECT_EQ(compare(apart, apart).pairs, 0u);
  EXPECT_FALSE(compare(apart, apart).worse);
  MapQualityOptions none;
  none.pairs = 0;
  EXPECT_EQ(compare(true_poses_, true_poses_, none).pairs, 0u);
}

}  // namespace
}  // namespace groundloop
