// Our registration against PCL's generalised ICP on the same real scans: at least as accurate.
#include "backend/registration/registration.hpp"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>

#include "tests/support/registration_pair.hpp"

namespace groundloop {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

Cloud::Ptr downsampled(const Points& points, float voxel) {
  const Cloud::Ptr cloud(new Cloud);
  for (const Eigen::Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  Cloud::Ptr result(new Cloud);
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  filter.setLeafSize(voxel, voxel, voxel);
  filter.setInputCloud(cloud);
  filter.filter(*result);
  return result;
}

Pose pcl_gicp(const testing::RegistrationPair& pair, const Pose& start) {
  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> gicp;
  gicp.setInputSource(downsampled(pair.source, 0.25F));
  gicp.setInputTarget(downsampled(pair.target, 0.25F));
  gicp.setMaxCorrespondenceDistance(1.0);
  gicp.setMaximumIterations(100);
  gicp.setTransformationEpsilon(1e-5);
  gicp.setRotationEpsilon(1e-5);
  Cloud aligned;
  gicp.align(aligned, start.matrix().cast<float>());
  const Eigen::Matrix4d m = gicp.getFinalTransformation().cast<double>();
  return {Eigen::Matrix3d(m.topLeftCorner<3, 3>()), Eigen::Vector3d(m.topRightCorner<3, 1>())};
}

class AgainstPcl : public ::testing::TestWithParam<double> {};

TEST_P(AgainstPcl, IsAtLeastAsAccurateAsGeneralizedIcp) {
  const testing::RegistrationPair pair = testing::registration_pair();
  if (pair.source.empty()) GTEST_SKIP() << "needs " GROUNDLOOP_SHARED_DATA "/registration";
  Vector6d xi;
  xi << 0.5, -0.3, 0.1, 0.0, 0.0, 0.02;
  const Pose start = pair.T_target_source * exp_se3(GetParam() * xi);
  RegistrationOptions options;
  options.voxel_size = 0.25;
  const RegistrationResult ours =
      register_points(RegistrationTarget(pair.target, options), pair.source, start, options);
  const Vector6d our_error = log_se3(pair.T_target_source.inverse() * ours.T_target_source);
  const Vector6d pcl_error = log_se3(pair.T_target_source.inverse() * pcl_gicp(pair, start));
  // The reference pose itself is good to about a centimetre and a tenth of a degree.
  EXPECT_TRUE(ours.converged);
  EXPECT_LT(our_error.head<3>().norm(), pcl_error.head<3>().norm() + 0.01);
  EXPECT_LT(our_error.tail<3>().norm(),
            pcl_error.tail<3>().norm() + 0.1 * std::numbers::pi / 180.0);
}

INSTANTIATE_TEST_SUITE_P(Starts, AgainstPcl, ::testing::Values(0.0, 1.0, -1.0));

}  // namespace
}  // namespace groundloop
