#include "backend/mapping/scan_keeper.hpp"

#include <cmath>
#include <set>
#include <sstream>
#include <tuple>

#include <gtest/gtest.h>

#include "frontend/core/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::TemporaryFolder;

Pose at(double x, double yaw_deg = 0.0) {
  return {exp_so3({0.0, 0.0, yaw_deg * M_PI / 180.0}), {x, 0.0, 0.0}};
}

// A grid of points 0.1 m apart on a wall.
Points wall(int columns = 50) {
  Points points;
  for (int i = 0; i < columns; ++i) {
    for (int k = 0; k < 20; ++k)
      points.emplace_back(5.0F, 0.05F + 0.1F * static_cast<float>(i),
                          0.05F + 0.1F * static_cast<float>(k));
  }
  return points;
}

std::vector<std::uint32_t> kept_scans(const SessionFolder& folder, std::size_t files) {
  std::vector<std::uint32_t> scans;
  for (std::size_t n = 0; n < files; ++n) {
    for (const KeptScan& scan : read_scan_file(folder.scan_file(n))) scans.push_back(scan.scan);
  }
  return scans;
}

TEST(ScanKeeper, KeepsAScanOnceTheSensorHasMovedOrTurned) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  KeptScanOptions options;
  options.spacing = 1.0;
  options.turn_deg = 10.0;
  ScanKeeper keeper(session, options);
  keeper.add(wall(), {}, at(0.0));
  keeper.add(wall(), {}, at(0.6));
  keeper.add({}, {}, at(1.1));  // predicted: it has no points
  keeper.add(wall(), {}, at(1.2));
  keeper.add(wall(), {}, at(1.2, 9.0));
  keeper.add(wall(), {}, at(1.2, 11.0));
  keeper.add(wall(), {}, at(1.2, 12.0));
  keeper.finish();
  EXPECT_EQ(kept_scans(session, keeper.files()), (std::vector<std::uint32_t>{0, 3, 5}));
}

TEST(ScanKeeper, KeepsOneOfItsOwnPointsAVoxelWithItsIntensity) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  KeptScanOptions options;
  options.voxel_size = 0.2;
  ScanKeeper keeper(session, options);
  const Points points = wall();
  std::vector<float> intensity;
  for (std::size_t i = 0; i < points.size(); ++i) intensity.push_back(static_cast<float>(i % 256));
  keeper.add(points, intensity, at(0.0));
  keeper.finish();
  const KeptScan scan = read_scan_file(session.scan_file(0)).front();
  EXPECT_EQ(scan.points.size(), points.size() / 4);
  std::set<std::tuple<int, int>> voxels;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    voxels.insert({std::lround(std::floor(p.y() / 0.2F)), std::lround(std::floor(p.z() / 0.2F))});
    const auto same = std::find_if(points.begin(), points.end(), [&](const Eigen::Vector3f& q) {
      return (p - q).cwiseAbs().maxCoeff() <= 1.0F / 256;
    });
    ASSERT_NE(same, points.end());
    EXPECT_EQ(scan.intensity[i], intensity[same - points.begin()]);
  }
  EXPECT_EQ(voxels.size(), scan.points.size());
}

TEST(ScanKeeper, WritesFilesOfBoundedSizeAndNothingWhereNothingIsWanted) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  KeptScanOptions options;
  options.voxel_size = 0.05;
  ScanKeeper keeper(session, options);
  const Points points = wall(2000);  // 240 kB
  for (int i = 0; i < 60; ++i) keeper.add(points, {}, at(i));
  keeper.finish();
  EXPECT_EQ(keeper.files(), 4U);
  for (std::size_t n = 0; n < keeper.files(); ++n)
    EXPECT_LT(std::filesystem::file_size(session.scan_file(n)), 5'000'000U);
  EXPECT_EQ(kept_scans(session, keeper.files()).size(), 60U);

  const TemporaryFolder none;
  options.keep = false;
  ScanKeeper idle(SessionFolder(none / "idle"), options);
  idle.add(points, {}, at(0.0));
  idle.finish();
  EXPECT_EQ(idle.files(), 0U);
  EXPECT_FALSE(std::filesystem::exists(none / "idle"));
}

TEST(ScanKeeper, GoesOnFromItsStateWithTheSameBytes) {
  const TemporaryFolder folder;
  const SessionFolder whole(folder / "whole"), cut(folder / "cut");
  KeptScanOptions options;
  options.voxel_size = 0.05;
  ScanKeeper straight(whole, options), before(cut, options), after(cut, options);
  const Points points = wall(2000);
  for (int i = 0; i < 40; ++i) straight.add(points, {}, at(0.3 * i));
  straight.finish();
  for (int i = 0; i < 31; ++i) before.add(points, {}, at(0.3 * i));
  std::stringstream state;
  before.save(state);
  for (int i = 31; i < 35; ++i) before.add(points, {}, at(0.3 * i));  // what a kill undoes
  after.load(state);
  for (int i = 31; i < 40; ++i) after.add(points, {}, at(0.3 * i));
  after.finish();
  ASSERT_EQ(after.files(), straight.files());
  for (std::size_t n = 0; n < after.files(); ++n)
    EXPECT_EQ(read_text(whole.scan_file(n)), read_text(cut.scan_file(n))) << n;
}

}  // namespace
}  // namespace groundloop
