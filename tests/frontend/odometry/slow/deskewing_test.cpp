// Per-point times as readers give them make a map sharper: scans of a walker who swings and turns,
// read back from files, put together at ground-truth poses with and without deskewing.
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "frontend/odometry/preprocessing.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

// Mean entropy of the Gaussians that points in cells of half a metre make (Droeschel and Behnke,
// 2014, with cells instead of balls); lower is sharper.
double map_entropy(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kCell = 0.5;
  constexpr std::size_t kFewest = 20;
  std::map<std::tuple<int, int, int>, std::vector<Eigen::Vector3d>> cells;
  for (const Eigen::Vector3d& p : points) {
    cells[{static_cast<int>(std::floor(p.x() / kCell)), static_cast<int>(std::floor(p.y() / kCell)),
           static_cast<int>(std::floor(p.z() / kCell))}]
        .push_back(p);
  }
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& [cell, members] : cells) {
    if (members.size() < kFewest) continue;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : members) mean += p / static_cast<double>(members.size());
    Eigen::Matrix3d covariance = 1e-6 * Eigen::Matrix3d::Identity();
    for (const Eigen::Vector3d& p : members) {
      covariance += (p - mean) * (p - mean).transpose() / static_cast<double>(members.size());
    }
    sum += 0.5 * std::log((2 * std::numbers::pi * std::numbers::e * covariance).determinant()) *
           static_cast<double>(members.size());
    count += members.size();
  }
  return sum / static_cast<double>(count);
}

TEST(Deskewing, SharpensTheMapOfASwingingWalker) {
  RecordingOptions options;
  options.first = 30;
  options.count = 12;
  const auto simulated =
      open_any_recording("sim:town?sensor=spin32&carrier=walker&length=60", options);
  for (const char* layout : {"kitti", "rosbag2"}) {
    testing::TemporaryFolder folder;
    write_layout(*simulated, layout, folder / "out");
    const auto recording = open_recording((folder / "out").string());
    const Trajectory truth = recording->ground_truth();
    std::vector<Eigen::Vector3d> raw, deskewed;
    for (std::size_t i = 0; i + 1 < recording->size(); ++i) {
      const Scan scan = recording->read(i);
      const double seconds = 1e-9 * static_cast<double>(truth[i + 1].stamp - truth[i].stamp);
      const Vector6d twist = log_se3(truth[i].pose.inverse() * truth[i + 1].pose) / seconds;
      for (const auto& [velocity, map] :
           {std::pair{Vector6d(Vector6d::Zero()), &raw}, {twist, &deskewed}}) {
        for (const Eigen::Vector3f& p : deskew_and_crop(scan, {velocity}, 0.0, 1.0, 40.0)) {
          map->push_back(truth[i].pose * p.cast<double>());
        }
      }
    }
    const double blurred = map_entropy(raw), sharp = map_entropy(deskewed);
    std::printf("%s: map entropy %.3f as scanned, %.3f deskewed\n", layout, blurred, sharp);
    EXPECT_LT(sharp, blurred - 0.1);
  }
}

}  // namespace
}  // namespace groundloop
