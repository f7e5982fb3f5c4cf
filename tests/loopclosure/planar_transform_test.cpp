#include "loopclosure/planar_transform.hpp"

#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace groundloop {
namespace {

std::vector<Eigen::Vector2d> random_points(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(-50, 50);
  std::vector<Eigen::Vector2d> points(n);
  for (Eigen::Vector2d& p : points) p = {uniform(rng), uniform(rng)};
  return points;
}

TEST(PlanarTransform, FitRecoversAnExactMotion) {
  const PlanarTransform T{2.5, {30, -7}};
  const std::vector<Eigen::Vector2d> b = random_points(12, 1);
  std::vector<Eigen::Vector2d> a;
  for (const Eigen::Vector2d& p : b) a.push_back(T * p);
  const PlanarTransform fit = fit_planar_transform(a, b);
  EXPECT_NEAR(wrap_angle(fit.angle - T.angle), 0, 1e-12);
  EXPECT_LT((fit.translation - T.translation).norm(), 1e-10);
}

TEST(PlanarTransform, FitAgreesWithEigensUmeyama) {
  std::mt19937_64 rng(2);
  std::normal_distribution<double> noise(0, 1);
  const std::vector<Eigen::Vector2d> b = random_points(20, 3);
  std::vector<Eigen::Vector2d> a;
  Eigen::MatrixXd A(2, 20), B(2, 20);
  for (std::size_t i = 0; i < b.size(); ++i) {
    a.push_back(PlanarTransform{-0.8, {3, 4}} * b[i] + Eigen::Vector2d(noise(rng), noise(rng)));
    A.col(static_cast<Eigen::Index>(i)) = a[i];
    B.col(static_cast<Eigen::Index>(i)) = b[i];
  }
  const Eigen::MatrixXd expected = Eigen::umeyama(B, A, false);
  const PlanarTransform fit = fit_planar_transform(a, b);
  EXPECT_LT((rotation_matrix(fit) - expected.topLeftCorner(2, 2)).norm(), 1e-10);
  EXPECT_LT((fit.translation - expected.topRightCorner(2, 1)).norm(), 1e-9);
}

TEST(PlanarTransform, FitOfAMirrorImageIsStillARotation) {
  const std::vector<Eigen::Vector2d> b = random_points(30, 4);
  std::vector<Eigen::Vector2d> a;
  for (const Eigen::Vector2d& p : b) a.emplace_back(p.x(), -p.y());
  const PlanarTransform fit = fit_planar_transform(a, b);
  EXPECT_NEAR(rotation_matrix(fit).determinant(), 1.0, 1e-12);
  // No rotation does better.
  const auto cost = [&](double angle) {
    PlanarTransform T;
    T.angle = angle;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < a.size(); ++i) mean += (a[i] - T * b[i]) / 30.0;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - T * b[i] - mean).squaredNorm();
    return sum;
  };
  for (int k = 0; k < 360; ++k) EXPECT_GE(cost(k * M_PI / 180), cost(fit.angle) - 1e-9);
}

TEST(PlanarTransform, FitOfNoneOrOnePointDoesNotTurn) {
  EXPECT_EQ(fit_planar_transform({}, {}).angle, 0.0);
  const std::vector<Eigen::Vector2d> a{{3, 4}}, b{{1, 1}};
  const PlanarTransform fit = fit_planar_transform(a, b);
  EXPECT_EQ(fit.angle, 0.0);
  EXPECT_EQ(fit.translation, Eigen::Vector2d(2, 3));
}

TEST(PlanarTransform, LiftMovesPointsOfThePlaneAlike) {
  const PlanarTransform T{0.7, {2, -5}};
  const Eigen::Vector3d lifted = lift(T) * Eigen::Vector3d(4, 6, 1.5);
  EXPECT_LT((lifted.head<2>() - T * Eigen::Vector2d(4, 6)).norm(), 1e-12);
  EXPECT_EQ(lifted.z(), 1.5);
}

}  // namespace
}  // namespace groundloop
