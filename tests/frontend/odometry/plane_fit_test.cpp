#include "frontend/odometry/plane_fit.hpp"

#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace groundloop {
namespace {

constexpr PlaneLimits kLimits{8.0F, 0.1F, 0.5F};

PlaneMoments moments_of(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& origin) {
  PlaneMoments moments;
  for (const Eigen::Vector3f& p : points) moments.add(p - origin);
  return moments;
}

TEST(PlaneFit, FindsATiltedPlaneFarFromTheOriginOfTheWorld) {
  const Eigen::Vector3f normal = Eigen::Vector3f(0.2F, -0.3F, 0.9F).normalized();
  const Eigen::Vector3f u = normal.unitOrthogonal(), v = normal.cross(u);
  const Eigen::Vector3f center(40000.0F, -20000.0F, 300.0F);
  std::vector<Eigen::Vector3f> points;
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j)
      points.emplace_back(static_cast<float>(i) * 0.3F * u + static_cast<float>(j) * 0.3F * v);
  }
  // Relative to the origin given, floats hold the shape.
  PlaneMoments moments;
  for (const Eigen::Vector3f& p : points) moments.add(p);
  const Plane plane = fit_plane(moments, center, kLimits);
  ASSERT_TRUE(plane.exists());
  EXPECT_NEAR(std::abs(plane.normal.dot(normal)), 1.0F, 1e-5F);
  EXPECT_LT((plane.point - center).norm(), 0.01F);
}

TEST(PlaneFit, ALineAFewPointsAndABlobAreNoPlanes) {
  std::vector<Eigen::Vector3f> line, few, blob;
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> uniform(-1.5F, 1.5F);
  for (int i = 0; i < 40; ++i) {
    line.emplace_back(0.07F * static_cast<float>(i), 0.0F, 0.0F);
    blob.emplace_back(uniform(rng), uniform(rng), uniform(rng));
    if (i < 7) few.emplace_back(uniform(rng), uniform(rng), 0.0F);
  }
  for (const auto& points : {line, few, blob}) {
    EXPECT_FALSE(fit_plane(moments_of(points, points[0]), points[0], kLimits).exists());
  }
}

}  // namespace
}  // namespace groundloop
