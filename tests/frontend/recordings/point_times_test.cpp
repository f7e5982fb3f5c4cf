// What the times of points mean: judged from several scans; a wild one costs its point, no more.
#include "frontend/recordings/point_times.hpp"

#include <cmath>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using recordings::FieldType;
using recordings::judge_times;
using recordings::TimeHints;
using recordings::TimeModel;
using recordings::TimeSample;
using testing::Bytes;
using ::testing::HasSubstr;
using testing::write_file;

constexpr Nanoseconds kTenth = 100'000'000;

// Scans a tenth of a second apart whose field begins at `begin` and runs by `step` from one to the
// next, `span` within one.
std::vector<TimeSample> samples(FieldType type, double begin, double step, double span,
                                Nanoseconds first_stamp = 1'600'000'000'000'000'000) {
  std::vector<TimeSample> list;
  for (int i = 0; i < 5; ++i)
    list.push_back({"t", type, first_stamp + i * kTenth, begin + i * step, span, 1000, 0});
  return list;
}

// Milliseconds since the sensor was switched on, advancing by 100 a scan: what a Robosense E1
// writes. Within a scan they advance by 29, which as nanoseconds would be possible, too.
TEST(JudgeTimes, UnitIsThatInWhichTheFieldRunsWithTheStamps) {
  const auto model = judge_times(samples(FieldType::uint32, 3725, 100, 29), {});
  ASSERT_TRUE(model);
  EXPECT_EQ(model->unit, "ms");
  EXPECT_EQ(model->zero, TimeModel::Zero::first_point);
  EXPECT_THAT(model->described(), HasSubstr("runs with the stamps"));
}

TEST(JudgeTimes, UnitOfTimesFromTheStampIsThatInWhichAScanLastsAsLongAsScansDo) {
  EXPECT_EQ(judge_times(samples(FieldType::uint32, 0, 0, 99'900'000), {})->unit, "ns");
  EXPECT_EQ(judge_times(samples(FieldType::uint32, 0, 0, 99'900), {})->unit, "us");
  EXPECT_EQ(judge_times(samples(FieldType::float32, 0, 0, 99.9), {})->unit, "ms");
  EXPECT_EQ(judge_times(samples(FieldType::float32, 0, 0, 0.0999), {})->unit, "s");
  // A sector of a tenth of the turn: still nearest to a scan in its own unit.
  EXPECT_EQ(judge_times(samples(FieldType::float32, 0, 0, 0.01), {})->unit, "s");
  EXPECT_EQ(judge_times(samples(FieldType::float32, 0, 0, 0.0999), {})->zero,
            TimeModel::Zero::stamp);
}

TEST(JudgeTimes, TimesBeforeTheStampStayBeforeIt) {  // Velodyne's driver: the stamp ends the scan
  const auto model = judge_times(samples(FieldType::float32, -0.0999, 0, 0.0999), {});
  EXPECT_EQ(model->zero, TimeModel::Zero::stamp);
  EXPECT_EQ(model->unit, "s");
}

TEST(JudgeTimes, OneScanThatDisagreesDecidesNothing) {
  auto list = samples(FieldType::uint32, 3725, 100, 29);
  list[2].begin = 4e9;
  const auto model = judge_times(list, {});
  EXPECT_EQ(model->unit, "ms");
}

TEST(JudgeTimes, TheUnitAskedForIsTaken) {
  TimeHints hints;
  hints.unit = "us";
  const auto model = judge_times(samples(FieldType::uint32, 0, 0, 99'900'000), hints);
  EXPECT_EQ(model->unit, "us");
  EXPECT_DOUBLE_EQ(model->seconds_per_unit, 1e-6);
  EXPECT_THAT(model->described(), HasSubstr("--time-unit overrules"));
  hints.unit = "minutes";
  EXPECT_THROW((void)judge_times(samples(FieldType::uint32, 0, 0, 1), hints), InputError);
}

class PointTimes : public ::testing::Test {
 protected:
  // Scans of 200 points along x, 0.5 ms apart, in float32 seconds from the stamp.
  void write_scans(float wild) {
    for (int s = 0; s < 3; ++s) {
      Bytes file;
      file.text(
          "VERSION 0.7\nFIELDS x y z ring t\nSIZE 4 4 4 2 4\nTYPE F F F U F\nCOUNT 1 1 1 1 1\n"
          "WIDTH 200\nHEIGHT 1\nPOINTS 200\nDATA binary\n");
      for (int i = 0; i < 200; ++i) {
        file.floats(1 + i, 2, 3).put(static_cast<std::uint16_t>(i % 16));
        file.put(i == 77 ? wild : 0.0005F * static_cast<float>(i));
      }
      write_file(folder_ / (std::to_string(1'600'000'000'000 + 100 * s) + "000000.pcd"), file);
    }
  }
  std::unique_ptr<Recording> open(const RecordingOptions& options = {}) {
    return open_recording(folder_.path().string(), options);
  }
  testing::TemporaryFolder folder_;
};

// 30 s off, a point would move the middle of the sweep by 15 s, and the scan with it.
TEST_F(PointTimes, AWildTimeCostsItsPointAndNoMore) {
  for (const float wild : {30.0F, -30.0F, 1e20F, 0.6F}) {
    write_scans(wild);
    RecordingOptions options;
    options.attributes.ring = true;
    const auto recording = open(options);
    const Scan scan = recording->read(1);
    ASSERT_EQ(scan.points.size(), 199U) << wild;
    ASSERT_EQ(scan.attributes.ring.size(), 199U);
    EXPECT_EQ(scan.points[77].x(), 79.0F);
    EXPECT_FLOAT_EQ(scan.times[77], 0.039F);
    EXPECT_EQ(scan.attributes.ring[77], 78 % 16);
    EXPECT_FLOAT_EQ(scan.times.back(), 0.0995F);
    EXPECT_THAT(recording->info().warnings, ::testing::Contains(HasSubstr("3 of 600 points")));
  }
}

TEST_F(PointTimes, TheStampNamesTheInstantAskedFor) {
  write_scans(0.0385F);
  RecordingOptions options;
  for (const auto& [instant, first] : std::vector<std::pair<std::string, float>>{
           {"start", 0.0F}, {"middle", -0.04975F}, {"end", -0.0995F}}) {
    options.stamp = instant;
    const Scan scan = open(options)->read(2);
    EXPECT_NEAR(scan.times.front(), first, 1e-6F);
    EXPECT_NEAR(scan.times.back(), first + 0.0995F, 1e-6F);
  }
  options.stamp = "noon";
  EXPECT_THROW((void)open(options), InputError);
}

TEST_F(PointTimes, AttributesAreReadOnlyWhereTheyAreAskedFor) {
  write_scans(0.0385F);
  EXPECT_TRUE(open()->info().attributes.ring);
  EXPECT_FALSE(open()->info().attributes.intensity);
  EXPECT_TRUE(open()->read(0).attributes.ring.empty());
  RecordingOptions options;
  options.attributes = AttributeSet::all();
  const Scan scan = open(options)->read(0);
  ASSERT_EQ(scan.attributes.ring.size(), 200U);
  EXPECT_EQ(scan.attributes.ring[17], 1);
  EXPECT_TRUE(scan.attributes.intensity.empty());
}

}  // namespace
}  // namespace groundloop
