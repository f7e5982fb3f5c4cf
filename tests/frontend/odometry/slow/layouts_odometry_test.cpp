// The same simulated drive through every layout gives the same odometry, to within what the layout
// can hold: millimetres where times are rounded (registration is sensitive to the last bit), two
// centimetres over 30 m where coordinates are in steps of 5 mm, nothing where all bits are kept.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/odometry/odometry.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

constexpr std::size_t kScans = 40;

Trajectory run_odometry(Recording& recording) {
  Odometry odometry{OdometryOptions()};
  odometry.start(recording.read(0), recording.read(1));
  Trajectory trajectory;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const Scan scan = recording.read(i);
    trajectory.push_back({scan.stamp, odometry.add(scan, std::to_string(i)).T_world_scan});
  }
  return trajectory;
}

struct Case {
  const char* layout;
  double tolerance_m;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.layout; }

class LayoutOdometry : public ::testing::TestWithParam<Case> {};

TEST_P(LayoutOdometry, IsThatOfTheRecordingItself) {
  RecordingOptions options;
  options.first = 20;
  options.count = kScans;
  const auto original = open_any_recording("sim:town?sensor=spin32&length=200&seed=3", options);
  testing::TemporaryFolder folder;
  write_layout(*original, GetParam().layout, folder / "out");
  const auto read = open_recording((folder / "out").string());
  static const Trajectory expected = run_odometry(*original);
  const Trajectory trajectory = run_odometry(*read);
  ASSERT_GE(trajectory.size() + 1, expected.size());
  double largest = 0.0;
  for (const StampedPose& pose : trajectory) {
    const auto nearest =
        std::min_element(expected.begin(), expected.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.stamp - pose.stamp) < std::abs(b.stamp - pose.stamp);
        });
    // A cut of NCLT's stream one column off moves a stamp by a tenth of a millisecond.
    if (std::abs(nearest->stamp - pose.stamp) > 1'000'000) continue;
    largest = std::max(largest, (nearest->pose.translation - pose.pose.translation).norm());
  }
  RecordProperty("largest_difference_mm", std::to_string(1e3 * largest));
  std::printf("%s: %zu scans, path %.1f m, largest difference %.3f mm\n", GetParam().layout,
              trajectory.size(), path_length(expected), 1e3 * largest);
  EXPECT_LE(largest, GetParam().tolerance_m);
}

INSTANTIATE_TEST_SUITE_P(All, LayoutOdometry,
                         ::testing::Values(Case{"kitti", 3e-3}, Case{"mulran", 3e-3},
                                           Case{"helipr", 3e-3}, Case{"nclt", 2e-2},
                                           Case{"rosbag", 3e-3}, Case{"rosbag2", 5e-3},
                                           Case{"mcap", 1e-6}, Case{"folder", 1e-6},
                                           Case{"livox", 3e-3}));

}  // namespace
}  // namespace groundloop
