#include <cmath>

#include <gtest/gtest.h>
#include <png.h>

#include "apps/report/surface_thickness.hpp"
#include "apps/report/top_view.hpp"

namespace groundloop::apps {
namespace {

TEST(TopView, ShowsWhatStandsUprightDarkerThanTheGround) {
  TopWindow window{{-10.0, 0.0}, 1.0, 20, 10};
  TopView view(window);
  view.add({-9.5F, 0.5F, 0.0F});                                       // ground, lower left
  for (const float z : {0.0F, 1.0F, 3.0F}) view.add({9.5F, 9.5F, z});  // a pole, upper right
  view.add({50.0F, 0.0F, 0.0F});                                       // outside
  const GreyPicture picture = view.draw();
  ASSERT_EQ(picture.pixels.size(), 200U);
  const int ground = picture.pixels[9 * 20];
  const int pole = picture.pixels[19];
  EXPECT_EQ(pole, 0);
  EXPECT_GT(ground, 150);
  EXPECT_LT(ground, 255);
  EXPECT_EQ(picture.pixels[100], 255);  // not seen
}

TEST(TopView, WindowHoldsThePositionsAndNoMorePixelsThanAsked) {
  const std::vector<Eigen::Vector3d> way{{0, 0, 0}, {1000, 100, 5}, {NAN, 0, 0}};
  const TopWindow window = window_around(way, 1400);
  EXPECT_LE(std::max(window.width, window.height), 1400);
  EXPECT_LT(window.low.x(), 0.0);
  EXPECT_GT(window.low.x() + window.width * window.pixel, 1000.0);
  EXPECT_GT(window.low.y() + window.height * window.pixel, 100.0);
  // Of a stand still the surroundings are shown, and no pixel is finer than a decimetre.
  const TopWindow still = window_around({{5, 5, 0}});
  EXPECT_GE(still.pixel, 0.1);
  EXPECT_GT(still.width * still.pixel, 20.0);
}

TEST(GreyPicture, ComesBackFromItsPng) {
  const GreyPicture picture{3, 2, {0, 17, 34, 51, 68, 255}};
  const std::vector<std::byte> png = to_png(picture);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0);
  image.format = PNG_FORMAT_GRAY;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  EXPECT_EQ(image.width, 3U);
  EXPECT_EQ(image.height, 2U);
  EXPECT_EQ(pixels, picture.pixels);
}

// Two planes 2h apart, as many points on each: the deviation across is h.
TEST(SurfaceThickness, OfAWallDrawnTwiceIsHalfTheDistance) {
  constexpr float kHalf = 0.06F;
  SurfaceThickness thickness;
  const Eigen::Vector3f asked(0.5F, 0.5F, 0.5F);
  thickness.ask(asked);
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      for (const float z : {0.5F - kHalf, 0.5F + kHalf})
        thickness.add(
            {0.025F + 0.05F * static_cast<float>(x), 0.025F + 0.05F * static_cast<float>(y), z});
    }
  }
  EXPECT_NEAR(thickness.at(asked), kHalf, 1e-4F);
  EXPECT_LT(thickness.at({5.5F, 0.5F, 0.5F}), 0.0F);  // was not asked for
}

TEST(SurfaceThickness, ALineOrAFewPointsAreNoSurface) {
  SurfaceThickness thickness;
  const Eigen::Vector3f line(0.5F, 0.5F, 0.5F);
  const Eigen::Vector3f few(3.5F, 0.5F, 0.5F);
  thickness.ask(line);
  thickness.ask(few);
  for (int i = 0; i < 50; ++i) thickness.add({0.01F + 0.019F * static_cast<float>(i), 0.5F, 0.5F});
  for (const float x : {0.1F, 0.2F, 0.3F, 0.4F, 0.5F}) thickness.add({3.0F + x, x, 0.5F});
  EXPECT_LT(thickness.at(line), 0.0F);
  EXPECT_LT(thickness.at(few), 0.0F);
}

}  // namespace
}  // namespace groundloop::apps
