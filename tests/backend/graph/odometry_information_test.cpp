#include "backend/graph/odometry_information.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace groundloop {
namespace {

Vector6d gaussian(std::mt19937& generator, const Matrix6d& covariance) {
  std::normal_distribution<double> normal;
  Vector6d z;
  for (int i = 0; i < 6; ++i) z[i] = normal(generator);
  return covariance.llt().matrixL() * z;
}

Matrix6d full_covariance(std::mt19937& generator, double scale) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Matrix6d m;
  for (int i = 0; i < 36; ++i) m(i) = uniform(generator);
  return scale * scale * (m * m.transpose() + Matrix6d::Identity());
}

TEST(RelativePose, CompositionAgreesWithSampling) {
  std::mt19937 generator(1);
  Vector6d twist;
  twist << 4, -2, 1, 0.5, -0.7, 1.1;
  const RelativePose a{exp_se3(twist), full_covariance(generator, 0.003)};
  twist << -1, 3, 2, 0.1, 0.4, -0.9;
  const RelativePose b{exp_se3(twist), full_covariance(generator, 0.002)};
  const RelativePose product = a * b;
  const RelativePose back = inverse(product);
  Matrix6d sampled = Matrix6d::Zero(), sampled_back = Matrix6d::Zero();
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const Pose noisy = a.T_from_to * exp_se3(gaussian(generator, a.covariance)) * b.T_from_to *
                       exp_se3(gaussian(generator, b.covariance));
    const Vector6d e = log_se3(product.T_from_to.inverse() * noisy);
    const Vector6d f = log_se3(back.T_from_to.inverse() * noisy.inverse());
    sampled += e * e.transpose() / n;
    sampled_back += f * f.transpose() / n;
  }
  EXPECT_LT((sampled - product.covariance).norm(), 0.04 * product.covariance.norm());
  EXPECT_LT((sampled_back - back.covariance).norm(), 0.04 * back.covariance.norm());
}

TEST(RelativePose, MahalanobisDistanceUsesTheWholeCovariance) {
  std::mt19937 generator(2);
  const Matrix6d covariance = full_covariance(generator, 0.1);
  const Vector6d r = Vector6d::LinSpaced(0.1, 0.4);
  EXPECT_NEAR(squared_mahalanobis({exp_se3(r), covariance}), r.dot(covariance.inverse() * r), 1e-8);
}

TEST(OdometryInformation, IsTheInverseOfTheCovariance) {
  const Pose step(Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ())), {1, 0, 0});
  const Matrix6d product = odometry_covariance(step, {}) * odometry_information(step, {});
  EXPECT_LT((product - Matrix6d::Identity()).norm(), 1e-12);
  EXPECT_LT(odometry_information(Pose(), {}).maxCoeff(), 1e10);
}

// A straight line of length L: sigma^2 = a^2 L along it, a^2 L + b^2 L^3 / 3 across.
TEST(OdometryInformation, GrowsAsARandomWalkOfTranslationAndHeading) {
  OdometryInformationOptions options;
  options.translation_floor = 1e-6;
  options.rotation_floor = 1e-8;
  for (const int length : {100, 1000, 4000}) {
    std::vector<Pose> line(length + 1);
    for (int i = 0; i <= length; ++i) line[i].translation.x() = i;
    const Matrix6d covariance =
        compose_odometry(line, 0, static_cast<std::size_t>(length), options).covariance;
    const double along = options.translation * std::sqrt(length);
    const double across = options.rotation * std::sqrt(std::pow(length, 3) / 3.0);
    EXPECT_NEAR(std::sqrt(covariance(0, 0)), along, 1e-3 * along);
    EXPECT_NEAR(std::sqrt(covariance(1, 1)), std::hypot(along, across), 0.02 * across);
    EXPECT_NEAR(std::sqrt(covariance(5, 5)), options.rotation * std::sqrt(length), 1e-6);
  }
}

TEST(OdometryInformation, DoesNotDependOnHowTheWayIsCut) {
  // A quarter circle in 10 and in 1000 steps.
  OdometryInformationOptions options;
  options.translation_floor = 1e-6;
  options.rotation_floor = 1e-8;
  const auto covariance = [&](int steps) {
    std::vector<Pose> arc;
    for (int i = 0; i <= steps; ++i) {
      const double angle = 0.5 * M_PI * i / steps;
      arc.emplace_back(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
                       Eigen::Vector3d(50 * std::sin(angle), 50 - 50 * std::cos(angle), 0));
    }
    return compose_odometry(arc, 0, static_cast<std::size_t>(steps), options).covariance;
  };
  const Matrix6d coarse = covariance(20);
  const Matrix6d fine = covariance(1000);
  EXPECT_LT((coarse - fine).norm(), 0.1 * fine.norm());
}

TEST(OdometryChain, AgreesWithComposition) {
  std::vector<Pose> way;
  for (int i = 0; i <= 400; ++i) {
    const double angle = 0.01 * i;
    way.emplace_back(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
                     Eigen::Vector3d(1000 + i, 5 * std::sin(angle), 0.01 * i));
  }
  const OdometryChain chain(way, {});
  for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>(0, 400), {250, 300}, {7, 8}}) {
    const RelativePose expected = compose_odometry(way, from, to, {});
    const RelativePose forward = chain.between(from, to);
    const RelativePose backward = chain.between(to, from);
    const double scale = expected.covariance.norm();
    EXPECT_LT((forward.covariance - expected.covariance).norm(), 1e-6 * scale);
    EXPECT_LT((backward.covariance - inverse(expected).covariance).norm(),
              1e-6 * inverse(expected).covariance.norm());
    EXPECT_LT(log_se3(backward.T_from_to * expected.T_from_to).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace groundloop
