#include "apps/report/closure_pictures.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <png.h>

namespace groundloop::apps {
namespace {

// A floor with an L of two walls, 40 and 20 m long, in the map's own frame.
Points town_corner() {
  Points points;
  for (int x = -180; x <= 180; ++x) {
    for (int y = -180; y <= 180; ++y) {
      points.emplace_back(static_cast<float>(x) / 3, static_cast<float>(y) / 3, -1.7F);
    }
  }
  for (int along = 0; along <= 160; ++along) {
    for (int up = 0; up < 20; ++up) {
      const float a = 0.25F * static_cast<float>(along), z = -1.6F + 0.25F * static_cast<float>(up);
      points.emplace_back(a, 10.25F, z);
      if (a <= 20) points.emplace_back(-3.75F, a, z);
    }
  }
  return points;
}

struct Decoded {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  [[nodiscard]] bool white(std::size_t i) const {
    return rgb[3 * i] == 255 && rgb[3 * i + 1] == 255 && rgb[3 * i + 2] == 255;
  }
};

Decoded decode(const std::vector<std::byte>& png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0);
  image.format = PNG_FORMAT_RGB;
  Decoded result{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  result.rgb.resize(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, result.rgb.data(), 0, nullptr), 0);
  return result;
}

ClosureRecord closure(int reference, int query, const Pose& T_query_reference) {
  ClosureRecord record;
  record.reference_map = reference;
  record.query_map = query;
  record.inliers = 12;
  record.status = ClosureStatus::accepted;
  record.T_query_reference = T_query_reference;
  return record;
}

// The reference is the corner as it is, the query the same turned and shifted.
struct Scene {
  Pose T_query_reference{exp_so3({0.02, 0.01, 2.0}), {30.0, -12.0, 0.7}};
  Points reference = town_corner(), query;
  Scene() {
    for (const Eigen::Vector3f& p : reference) {
      query.push_back((T_query_reference * p.cast<double>().eval()).cast<float>());
    }
  }
  [[nodiscard]] Points operator()(int map) const { return map == 0 ? reference : query; }
};

TEST(ClosurePictures, BringBothMapsOfAClosureIntoOneFrame) {
  const Scene scene;
  const auto pictures = closure_pictures({closure(0, 9, scene.T_query_reference)}, scene, {});
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_EQ(pictures[0].caption, "Maps 0 and 9, 12 inliers");
  ASSERT_EQ(pictures[0].pngs.size(), 3U);
  const Decoded reference = decode(pictures[0].pngs[0]), query = decode(pictures[0].pngs[1]);
  ASSERT_EQ(reference.width, query.width);
  ASSERT_EQ(reference.height, query.height);
  std::size_t either = 0, both = 0;
  for (std::size_t i = 0; i < reference.rgb.size() / 3; ++i) {
    either += !reference.white(i) || !query.white(i) ? 1U : 0U;
    both += !reference.white(i) && !query.white(i) ? 1U : 0U;
  }
  // Walls of 40 and 20 m in pixels of 0.5 m; at the edges of pixels a point may fall on either
  // side.
  EXPECT_GE(either, 120U);
  EXPECT_GT(static_cast<double>(both), 0.9 * static_cast<double>(either));
}

TEST(ClosurePictures, ShowAWrongPoseAsStructureThatDoesNotMeet) {
  const Scene scene;
  const Pose wrong =
      scene.T_query_reference * Pose(Eigen::Quaterniond::Identity(), {5.0, 5.0, 0.0});
  const auto pictures = closure_pictures({closure(0, 9, wrong)}, scene, {});
  ASSERT_EQ(pictures.size(), 1U);
  const Decoded reference = decode(pictures[0].pngs[0]), query = decode(pictures[0].pngs[1]);
  std::size_t either = 0, both = 0;
  for (std::size_t i = 0; i < reference.rgb.size() / 3; ++i) {
    either += !reference.white(i) || !query.white(i) ? 1U : 0U;
    both += !reference.white(i) && !query.white(i) ? 1U : 0U;
  }
  EXPECT_LT(static_cast<double>(both), 0.1 * static_cast<double>(either));
}

TEST(ClosurePictures, PointUpAlongYAndRightAlongX) {
  // The long wall lies at y = 10, the short one at x = -4 from y = 0 to 20: of the long one's row,
  // the ink right of the short one's column is 40 m, left of it there is none.
  const Scene scene;
  const auto pictures = closure_pictures({closure(0, 9, scene.T_query_reference)}, scene, {});
  const Decoded reference = decode(pictures.at(0).pngs.at(0));
  int right = 0, left = 0, highest = reference.height, lowest = -1;
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      if (reference.white(static_cast<std::size_t>(y * reference.width + x))) continue;
      highest = std::min(highest, y), lowest = std::max(lowest, y);
      (2 * x > reference.width ? right : left) += 1;
    }
  }
  // 120 m wide from x = -60, so x = 0 is the middle.
  EXPECT_NEAR(right, 80, 4);
  EXPECT_NEAR(left, 41, 4);
  // y from 0 to 20 of -60 to 60, up: rows 40 to 60 m from the top.
  EXPECT_NEAR(0.5 * highest, 40.0, 1.5);
  EXPECT_NEAR(0.5 * lowest, 60.0, 1.5);
}

TEST(ClosurePictures, KeepToTheirLimits) {
  const Scene scene;
  std::vector<ClosureRecord> closures(20, closure(0, 9, scene.T_query_reference));
  closures[3].status = ClosureStatus::outlier;
  EXPECT_EQ(closure_pictures(closures, scene, {}, {3, 200.0, 1 << 20}).size(), 3U);
  EXPECT_TRUE(closure_pictures(closures, scene, {}, {3, 200.0, 100}).empty());
  const auto small = closure_pictures(closures, scene, {}, {1, 20.0, 1 << 20});
  ASSERT_EQ(small.size(), 1U);
  EXPECT_LE(decode(small[0].pngs[0]).width, 40);
  EXPECT_LE(decode(small[0].pngs[0]).height, 40);
}

TEST(ClosurePictures, LeaveOutWhatWasNotAcceptedOrHasNoPoints) {
  const Scene scene;
  ClosureRecord rejected = closure(0, 9, scene.T_query_reference);
  rejected.status = ClosureStatus::low_overlap;
  EXPECT_TRUE(closure_pictures({rejected}, scene, {}).empty());
  EXPECT_TRUE(closure_pictures({}, scene, {}).empty());
  const auto nothing = [](int) { return Points(); };
  EXPECT_TRUE(closure_pictures({closure(0, 1, Pose())}, nothing, {}).empty());
}

}  // namespace
}  // namespace groundloop::apps
