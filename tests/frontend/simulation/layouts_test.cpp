// A recording written in every layout and read again: stamps, points, times and ground truth come
// back to within what the layout can hold. (That readers are right about the real formats is shown
// by fixtures that do not know our writers.)
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using ::testing::HasSubstr;

// Five turns of a sensor of 16 beams and 512 columns, clockwise from straight behind, in a room;
// the carrier drives a curve.
class Room final : public Recording {
 public:
  explicit Room(bool timed = true) : timed_(timed) { info_.format = "room"; }
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return 5; }
  Nanoseconds stamp(std::size_t index) const override {
    return 1'700'000'000'123'456'000 + static_cast<Nanoseconds>(index) * 100'000'000;
  }
  Scan read(std::size_t index) override {
    Scan scan;
    scan.stamp = stamp(index);
    for (int c = 0; c < 512; ++c) {
      const double azimuth = std::numbers::pi - 2 * std::numbers::pi * (c + 0.25) / 512;
      for (int b = 0; b < 16; ++b) {
        const double elevation = (b - 10.5) * 0.03;
        const double range = 6.0 + std::cos(3 * azimuth) + 0.5 * static_cast<double>(index);
        scan.points.emplace_back(
            (range * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                     std::cos(elevation) * std::sin(azimuth), std::sin(elevation)))
                .cast<float>());
        if (timed_) scan.times.push_back(static_cast<float>(0.1 * c / 512));
      }
    }
    return scan;
  }
  Trajectory ground_truth() const override {
    Trajectory truth;
    for (std::size_t i = 0; i < size(); ++i) {
      const double s = 0.1 * static_cast<double>(i);
      truth.push_back({stamp(i), Pose(Eigen::Quaterniond(Eigen::AngleAxisd(
                                          s, Eigen::Vector3d(0.1, -0.2, 1).normalized())),
                                      Eigen::Vector3d(10 * s, s * s, 0.1 * s))});
    }
    return truth;
  }

 private:
  RecordingInfo info_;
  bool timed_;
};

struct Case {
  const char* layout;
  const char* sensor;
  double point_error_m, time_error_s;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.layout << c.sensor; }

class Layout : public ::testing::TestWithParam<Case> {};

TEST_P(Layout, GivesTheRecordingBack) {
  const Case c = GetParam();
  testing::TemporaryFolder folder;
  Room room;
  write_layout(room, c.layout, folder / "out", c.sensor);
  const auto read = open_recording((folder / "out").string());
  EXPECT_EQ(read->info().format, std::string(c.layout) == "livox" ? "rosbag" : c.layout);
  ASSERT_EQ(read->size(), room.size());
  const Trajectory truth = read->ground_truth(), expected_truth = room.ground_truth();
  ASSERT_EQ(truth.size(), expected_truth.size());
  for (std::size_t i = 0; i < room.size(); ++i) {
    EXPECT_EQ(read->stamp(i), room.stamp(i));
    const Scan scan = read->read(i), expected = room.read(i);
    ASSERT_EQ(scan.points.size(), expected.points.size());
    ASSERT_EQ(scan.times.size(), expected.times.size());
    double point_error = 0.0, time_error = 0.0;
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      point_error = std::max<double>(
          point_error, (scan.points[k] - expected.points[k]).lpNorm<Eigen::Infinity>());
      time_error = std::max<double>(time_error, std::abs(scan.times[k] - expected.times[k]));
    }
    EXPECT_LE(point_error, c.point_error_m);
    EXPECT_LE(time_error, c.time_error_s);
    // Up to a world of the layout's own.
    const Pose step = truth[0].pose.inverse() * truth[i].pose;
    const Pose expected_step = expected_truth[0].pose.inverse() * expected_truth[i].pose;
    EXPECT_LT(log_se3(expected_step.inverse() * step).norm(), 1e-9);
    EXPECT_EQ(truth[i].stamp, room.stamp(i));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, Layout,
    ::testing::Values(Case{"kitti", "", 0, 1e-8}, Case{"mulran", "", 0, 1e-4},
                      Case{"helipr", "Ouster", 0, 1e-9}, Case{"helipr", "Velodyne", 0, 0},
                      Case{"helipr", "Avia", 0, 1e-9}, Case{"helipr", "Aeva", 0, 1e-9},
                      // 5 mm steps; hits of a packet are spread to the next one
                      Case{"nclt", "", 0.0026, 2.1e-4}, Case{"rosbag", "", 0, 1e-8},
                      Case{"rosbag2", "", 0, 4e-7}, Case{"mcap", "", 0, 0},
                      Case{"folder", "", 0, 0}, Case{"livox", "", 0, 1e-8}));

TEST(Layouts, HoldScansWithoutTimes) {
  for (const std::string& layout : layout_names()) {
    testing::TemporaryFolder folder;
    Room room(false);
    write_layout(room, layout, folder / "out");
    const auto read = open_recording((folder / "out").string());
    const Scan scan = read->read(2), expected = room.read(2);
    ASSERT_EQ(scan.points.size(), expected.points.size()) << layout;
    EXPECT_LT((scan.points[77] - expected.points[77]).norm(), 0.005) << layout;
    if (layout == "helipr") continue;  // its records always have a time
    EXPECT_TRUE(scan.times.empty()) << layout;
  }
}

TEST(Layouts, AreNotWrittenOverWhatIsThere) {
  testing::TemporaryFolder folder;
  Room room;
  write_layout(room, "folder", folder / "out");
  EXPECT_THROW(write_layout(room, "kitti", folder / "out"), InputError);
  EXPECT_EQ(open_recording((folder / "out").string())->info().format, "folder");
  EXPECT_THROW(write_layout(room, "pcap", folder / "other"), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "other"));
}

TEST(Layouts, KittiOfASimulatedSensorIsNotCorrectedInElevation) {
  testing::TemporaryFolder folder;
  RecordingOptions options;
  options.count = 3;
  const auto simulated = open_any_recording("sim:town?sensor=spin64&length=30", options);
  write_layout(*simulated, "kitti", folder / "out");
  const auto read = open_recording((folder / "out").string());
  EXPECT_THAT(read->info().notes.back(), HasSubstr("not corrected"));
}

}  // namespace
}  // namespace groundloop
