#include "loopclosure/density_image.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

using Pixels = std::vector<std::uint8_t>;

void add(Points& points, int count, float x, float y) {
  for (int i = 0; i < count; ++i) points.emplace_back(x, y, static_cast<float>(i));
}

TEST(DensityImage, EqualsAHandCountedGrid) {
  Points points;
  add(points, 1, -0.6F, 0.1F);   // cell (-2, 0)
  add(points, 11, 0.2F, 0.4F);   // cell (0, 0)
  add(points, 5, 0.2F, 0.6F);    // cell (0, 1)
  add(points, 21, -0.1F, 1.2F);  // cell (-1, 2)
  add(points, 2, -1.0F, 1.0F);   // cell (-2, 2): its lower corner belongs to it
  const DensityImage image = make_density_image(points, Pose(), {});
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 3);
  EXPECT_EQ(image.first_cell, Eigen::Vector2i(-2, 0));
  // (n - 1) / 20 of 255: 11 -> 127.5 -> 128, 5 -> 51, 21 -> 255, 2 -> 12.75 -> 13 (exactly 5 %).
  EXPECT_EQ(image.pixels, (Pixels{0, 0, 128,  //
                                  0, 0, 51,   //
                                  13, 255, 0}));
}

TEST(DensityImage, DropsWhatIsUnderTheLeastDensity) {
  Points points;
  add(points, 101, 0.1F, 0.1F);
  add(points, 5, 0.6F, 0.1F);  // 4 %
  add(points, 6, 1.1F, 0.1F);  // 5 %
  add(points, 1, 1.6F, 0.1F);
  EXPECT_EQ(make_density_image(points, Pose(), {}).pixels, (Pixels{255, 0, 13, 0}));
}

TEST(DensityImage, OccupiedCellsAreFullWhereAllCountsAreEqual) {
  Points points;
  add(points, 3, 0.1F, 0.1F);
  add(points, 3, 1.1F, 0.1F);
  EXPECT_EQ(make_density_image(points, Pose(), {}).pixels, (Pixels{255, 0, 255}));
}

TEST(DensityImage, ProjectsInTheGroundFrame) {
  // A wall along the map's z axis lies along the ground's y axis after a quarter turn about x.
  Points points;
  for (int i = 0; i < 4; ++i) points.emplace_back(0.1F, 0.1F, 0.25F + 0.5F * static_cast<float>(i));
  const Pose T(exp_so3({-M_PI / 2, 0, 0}), Eigen::Vector3d(10, 0, 0));
  const DensityImage image = make_density_image(points, T, {});
  EXPECT_EQ(image.width, 1);
  EXPECT_EQ(image.height, 4);
  EXPECT_EQ(image.first_cell, Eigen::Vector2i(20, 0));
}

TEST(DensityImage, PixelCentresAreCellCentres) {
  Points points;
  add(points, 1, 7.3F, -3.9F);
  const DensityImage image = make_density_image(points, Pose(), {});
  EXPECT_EQ(image.to_metres(0, 0), Eigen::Vector2f(7.25F, -3.75F));
}

TEST(DensityImage, StaysBoundedWhateverThePoints) {
  Points points;
  add(points, 2, 0.1F, 0.1F);
  points.emplace_back(1e9F, 0, 0);
  points.emplace_back(0, -300, 0);
  points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  points.emplace_back(0, std::numeric_limits<float>::infinity(), 0);
  const DensityImage image = make_density_image(points, Pose(), {});
  EXPECT_EQ(image.width, 1);
  EXPECT_EQ(image.height, 1);
  EXPECT_EQ(image.dropped_points, 4U);
  EXPECT_EQ(image.pixels, Pixels{255});
}

TEST(DensityImage, NoPointsGiveAnEmptyImage) {
  const DensityImage image = make_density_image({}, Pose(), {});
  EXPECT_EQ(image.width, 0);
  EXPECT_EQ(image.height, 0);
  EXPECT_TRUE(image.pixels.empty());
}

}  // namespace
}  // namespace groundloop
