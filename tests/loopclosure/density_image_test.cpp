#include "loopclosure/density_image.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

using Pixels = std::vector<std::uint8_t>;

void add(Points& points, int count, float x, float y) {
  for (int i = 0; i < count; ++i) points.emplace_back(x, y, static_cast<float>(i));
}

// As the paper counts.
DensityImageOptions points_counted() {
  DensityImageOptions options;
  options.count = "points";
  return options;
}

TEST(DensityImage, EqualsAHandCountedGrid) {
  Points points;
  add(points, 1, -0.6F, 0.1F);   // cell (-2, 0)
  add(points, 11, 0.2F, 0.4F);   // cell (0, 0)
  add(points, 5, 0.2F, 0.6F);    // cell (0, 1)
  add(points, 21, -0.1F, 1.2F);  // cell (-1, 2)
  add(points, 2, -1.0F, 1.0F);   // cell (-2, 2): its lower corner belongs to it
  const DensityImage image = make_density_image(points, Pose(), points_counted());
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
  EXPECT_EQ(make_density_image(points, Pose(), points_counted()).pixels, (Pixels{255, 0, 13, 0}));
}

TEST(DensityImage, CountsTheLayersThatHoldPoints) {
  // Layers of half a metre about the ground: [-0.25, 0.25), [0.25, 0.75), ...
  Points points;
  const auto stand = [&](float x, std::vector<float> heights) {
    for (const float z : heights) points.emplace_back(x, 0.1F, z);
  };
  stand(0.1F, {-0.2F, 0.0F, 0.2F});                             // ground alone: 1
  stand(0.6F, {0.0F, 0.3F, 0.7F, 0.74F});                       // 2
  stand(1.1F, {0.0F, 0.5F, 1.0F, 1.5F, 2.0F, 2.5F});            // 6
  stand(1.6F, {0.0F, 2.0F, 4.0F, 40.0F, 50.0F, -5.0F, -6.0F});  // 5: what is far beyond is one
  stand(2.1F, std::vector<float>(100, 1.0F));                   // 1, however many points
  EXPECT_EQ(make_density_image(points, Pose(), {}).pixels, (Pixels{0, 51, 255, 204, 0}));
}

TEST(DensityImage, OfLayersDoesNotDependOnHowDenselyAPlaceWasSeen) {
  // A yard of walls sampled at random by one LiDAR and by another of ten times its density.
  const auto yard = [](std::uint64_t seed, int per_layer) {
    std::mt19937_64 rng(seed);
    std::uniform_real_distribution<float> unit(0.02F, 0.48F);
    Points points;
    for (int cell = 0; cell < 40; ++cell) {
      for (int layer = 0; layer < 1 + cell % 7; ++layer) {
        for (int i = 0; i < per_layer * (1 + cell % 3); ++i) {
          points.emplace_back(0.5F * static_cast<float>(cell) + unit(rng), unit(rng),
                              0.5F * static_cast<float>(layer) - 0.25F + unit(rng));
        }
      }
    }
    return points;
  };
  EXPECT_EQ(make_density_image(yard(1, 1), Pose(), {}).pixels,
            make_density_image(yard(2, 10), Pose(), {}).pixels);
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
