#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "backend/map/map_assembly.hpp"
#include "backend/session/scan_file.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/parallel.hpp"
#include "frontend/core/pcd.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::TemporaryFolder;

// Collects what an assembly writes.
class Collector : public PointCloudWriter {
 public:
  void write(std::span<const ExportPoint> points) override {
    all.insert(all.end(), points.begin(), points.end());
    count_ = all.size();
  }
  void finish() override {}
  std::vector<ExportPoint> all;
};

constexpr int kScans = 81;

// There and back along a wall at y = 10 m, turning on the way; the second visit passes half a metre
// beside the first.
Pose true_pose(int scan) {
  const bool back = scan > kScans / 2;
  const double x = back ? kScans - 1 - scan : scan;
  return {exp_so3({0.02 * std::sin(0.3 * scan), 0.0, back ? 3.1 : 0.1 * std::sin(0.2 * scan)}),
          {x, back ? 0.5 : 0.0, 0.0}};
}

// What odometry made of it: drifts sideways, 0.3 m at the end.
Pose odometry_pose(int scan) {
  Pose pose = true_pose(scan);
  pose.translation.y() += 0.3 * scan / (kScans - 1);
  return pose;
}

// The wall within 8 m along it, in the scan's frame.
Points seen(int scan) {
  const Pose T_scan_world = true_pose(scan).inverse();
  const double x = true_pose(scan).translation.x();
  Points points;
  for (int i = -16; i <= 16; ++i) {
    for (int k = 0; k < 12; ++k) {
      points.push_back(
          (T_scan_world * Eigen::Vector3d(std::round(x) + 0.5 * i + 0.25, 10.0, 0.25 + 0.5 * k))
              .cast<float>());
    }
  }
  return points;
}

struct Recorded {
  std::vector<LocalMapRecord> maps{1};
  Trajectory odometry, truth;
  std::size_t files = 0;
};

// The session's files of the walk: one local map, and its scans, a few a file.
Recorded record(const SessionFolder& session) {
  Recorded r;
  Points map;
  ScanFileBuilder builder;
  for (int i = 0; i < kScans; ++i) {
    r.odometry.push_back({i, odometry_pose(i)});
    r.truth.push_back({i, true_pose(i)});
    const Points points = seen(i);
    std::vector<float> intensity;
    for (std::size_t p = 0; p < points.size(); ++p)
      intensity.push_back(static_cast<float>(10 + i % 3));
    const PoseF T_map_scan(odometry_pose(0).inverse() * odometry_pose(i));
    for (const Eigen::Vector3f& p : points) map.push_back(T_map_scan * p);
    builder.add({static_cast<std::uint32_t>(i), points, intensity});
    if (i % 7 == 6 || i + 1 == kScans) builder.write(session.scan_file(r.files++));
  }
  r.maps[0].last_scan = kScans - 1;
  r.maps[0].points = map.size();
  write_pcd(session.local_map(0), map);
  return r;
}

double farthest_from_wall(const std::vector<MapPiece>& pieces, const TemporaryFolder& folder) {
  MapAssemblyOptions options;
  options.voxel_size = 0.05;
  Collector map;
  assemble_map(pieces, options, map, folder.path());
  double farthest = 0.0;
  for (const ExportPoint& point : map.all)
    farthest = std::max(farthest, std::abs(point.position.y() - 10.0));
  return farthest;
}

TEST(MapFromScans, HasEveryScanAtItsFinalPose) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  const Recorded r = record(session);
  const auto scans = recording_pieces(session, {r.maps, r.odometry, r.truth, 0, 0, r.files, 0});
  ASSERT_EQ(scans.size(), r.files);
  // What is left is rounding to 1/256 m, in each of three coordinates.
  EXPECT_LT(farthest_from_wall(scans, folder), std::sqrt(3.0) * 0.5 / 256 + 1e-4);
  // Without scans a local map is bent, and both visits of the wall are in it as odometry has them.
  const auto maps = recording_pieces(session, {r.maps, r.odometry, r.truth, 0, 0, 0, 0});
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_GT(farthest_from_wall(maps, folder), 0.05);
}

TEST(MapFromScans, HasTheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  const Recorded r = record(session);
  const auto pieces = recording_pieces(session, {r.maps, r.odometry, r.truth, 0, 0, r.files, 0});
  MapAssemblyOptions options;
  options.tile_size = 5.0;
  const auto write = [&](int threads, const char* name) {
    set_thread_count(threads);
    const auto writer = open_point_cloud_writer(folder / name, fields_of(pieces, false));
    assemble_map(pieces, options, *writer, folder.path());
    writer->finish();
    set_thread_count(0);
    return read_text(folder / name);
  };
  const std::string one = write(1, "one.pcd");
  EXPECT_GT(one.size(), 10'000U);
  EXPECT_EQ(one, write(2, "two.pcd"));
  EXPECT_EQ(one, write(3, "three.pcd"));
}

TEST(MapFromScans, HasTheMeanIntensityOfAVoxel) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  const Recorded r = record(session);
  const auto pieces = recording_pieces(session, {r.maps, r.odometry, r.truth, 0, 0, r.files, 0});
  const ExportFields fields = fields_of(pieces, false);
  EXPECT_TRUE(fields.intensity);
  EXPECT_EQ(fields.largest_intensity, 12.0F);
  MapAssemblyOptions options;
  options.voxel_size = 100.0;  // one voxel of all; the wall lies inside it
  Collector map;
  assemble_map(pieces, options, map, folder.path());
  double sum = 0.0, count = 0.0;
  for (int i = 0; i < kScans; ++i) {
    for (const Eigen::Vector3f& p : seen(i)) {
      // Of the voxel that begins at the world's origin.
      if ((true_pose(i) * p.cast<double>().eval()).x() < 0.0) continue;
      sum += 10 + i % 3;
      count += 1.0;
    }
  }
  const auto voxel = std::find_if(map.all.begin(), map.all.end(), [](const ExportPoint& p) {
    return p.position.x() > 0.0 && p.position.z() > 0.0;
  });
  ASSERT_NE(voxel, map.all.end());
  EXPECT_NEAR(voxel->intensity, sum / count, 1e-4);
}

TEST(MapFromScans, RefusesScansThatTheTrajectoryDoesNotHave) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  Recorded r = record(session);
  r.truth.pop_back();
  r.odometry.pop_back();
  const auto pieces = recording_pieces(session, {r.maps, r.odometry, r.truth, 0, 0, r.files, 0});
  Collector map;
  EXPECT_THROW(assemble_map(pieces, {}, map, folder.path()), InputError);
}

}  // namespace
}  // namespace groundloop
