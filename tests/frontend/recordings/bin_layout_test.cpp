// Headerless records told apart by their values; stamps in names; facts of data sets; sensors
// recognised.
#include "frontend/recordings/bin_layout.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/recordings/sensor_recognition.hpp"
#include "frontend/recordings/source_tools.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using recordings::choose_bin_layout;
using testing::Bytes;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::write_file;

class BinLayouts : public ::testing::Test {
 protected:
  // Scans of 32 rings over a street: ground and walls, 480 columns, in the order of firing or
  // shuffled. 15 360 points fit records of 16, 20, 24, 12 and 32 bytes alike.
  std::vector<fs::path> write_scans(std::size_t record, bool shuffled) {
    std::vector<fs::path> files;
    std::mt19937 random(7);
    for (int s = 0; s < 3; ++s) {
      std::vector<std::vector<float>> points;
      for (int column = 0; column < 480; ++column) {
        for (int ring = 0; ring < 32; ++ring) points.push_back(point(column, ring, s));
      }
      if (shuffled) std::shuffle(points.begin(), points.end(), random);
      Bytes file;
      for (const auto& p : points) {
        for (std::size_t i = 0; i < record; ++i) file.put(i < p.size() ? p[i] : 0.0F);
      }
      files.push_back(folder_ / ("scan" + std::to_string(s) + ".bin"));
      write_file(files.back(), file);
    }
    return files;
  }
  static std::vector<float> point(int column, int ring, int scan) {
    const double azimuth = 2 * std::numbers::pi * column / 480;
    const double elevation = (-30.67 + 1.333 * ring) * std::numbers::pi / 180;
    const double wall = 8.0 / std::max(std::abs(std::sin(azimuth + 0.01 * scan)), 0.15);
    const double ground = elevation < -0.01 ? 1.8 / std::sin(-elevation) : 1e9;
    const double range = std::min(wall / std::cos(elevation), ground);
    return {static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
            static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
            static_cast<float>(range * std::sin(elevation)),
            static_cast<float>((column * 7 + ring * 13) % 256),
            static_cast<float>(ring),
            static_cast<float>(0.1 * column / 480)};
  }
  testing::TemporaryFolder folder_;
};

TEST_F(BinLayouts, AreToldByTheirValuesWhateverTheOrderOfPoints) {
  for (const bool shuffled : {false, true}) {
    EXPECT_THAT(choose_bin_layout(write_scans(3, shuffled), "").fields, ElementsAre("x", "y", "z"));
    EXPECT_THAT(choose_bin_layout(write_scans(4, shuffled), "").fields,
                ElementsAre("x", "y", "z", "intensity"));
    const auto five = choose_bin_layout(write_scans(5, shuffled), "");
    EXPECT_THAT(five.fields, ElementsAre("x", "y", "z", "intensity", "ring"));
    EXPECT_THAT(five.evidence, HasSubstr("the fifth is a ring"));
    EXPECT_THAT(choose_bin_layout(write_scans(6, shuffled), "").fields,
                ElementsAre("x", "y", "z", "intensity", "ring", "t"));
  }
}

TEST_F(BinLayouts, AFolderOfThemIsReadRightly) {
  write_scans(5, false);
  RecordingOptions options;
  options.attributes = AttributeSet::all();
  const auto recording = open_recording(folder_.path().string(), options);
  const Scan scan = recording->read(1);
  ASSERT_EQ(scan.points.size(), 15'360U);
  const auto p = point(11, 5, 1);
  EXPECT_EQ(scan.points[11 * 32 + 5], Eigen::Vector3f(p[0], p[1], p[2]));
  EXPECT_EQ(scan.attributes.ring[11 * 32 + 5], 5);
  EXPECT_THAT(recordings::recognise_sensor({scan}).described(),
              ::testing::AllOf(HasSubstr("32 rings from -30.7 to +10.7 degrees, the whole turn"),
                               HasSubstr("Velodyne HDL-32E")));
}

TEST_F(BinLayouts, FieldsAskedForAreTaken) {
  write_scans(6, false);
  RecordingOptions options;
  options.fields = "x,y,z,a,b,time";
  const auto recording = open_recording(folder_.path().string(), options);
  EXPECT_EQ(recording->read(0).points.size(), 15'360U);
  EXPECT_FALSE(recording->info().attributes.ring);
  EXPECT_THAT(recording->info().point_times, HasSubstr("field 'time' (float32), s from the stamp"));
  options.fields = "x,y,intensity";
  EXPECT_THROW((void)open_recording(folder_.path().string(), options), InputError);
  options.fields = "";
  options.dataset = "nuscenes";  // says five values: these files are none of its
  const auto wrong = open_recording(folder_.path().string(), options);
  EXPECT_EQ(wrong->info().fields.size(), 5U);
  options.dataset = "kity";
  EXPECT_THROW((void)open_recording(folder_.path().string(), options), InputError);
}

struct NameCase {
  std::vector<std::string> names;
  const char* unit;
  Nanoseconds first, step;
};
class NameStamps : public ::testing::TestWithParam<NameCase> {};

TEST_P(NameStamps, AreRecognised) {
  std::vector<fs::path> files;
  for (const std::string& name : GetParam().names) files.emplace_back("folder/" + name);
  const auto stamps = recordings::stamps_from_names(files);
  ASSERT_TRUE(stamps) << GetParam().names.front();
  EXPECT_EQ(stamps->unit, GetParam().unit);
  EXPECT_EQ(stamps->stamps[0], GetParam().first);
  EXPECT_EQ(stamps->stamps[1] - stamps->stamps[0], GetParam().step);
}

// Seconds of the dates by `date -u`.
INSTANTIATE_TEST_SUITE_P(
    Patterns, NameStamps,
    ::testing::Values(NameCase{{"2021-10-26-16-21-29-468.pcd", "2021-10-26-16-21-29-568.pcd"},
                               "date and time",
                               1'635'265'289'468'000'000,
                               100'000'000},
                      NameCase{{"run_2011_09_26_14-02-34.pcd", "run_2011_09_26_14-02-33.pcd"},
                               "date and time",
                               1'317'045'753'000'000'000,
                               1'000'000'000},
                      NameCase{
                          {"n015-2018-07-24-11-22-45+0800__LIDAR_TOP__1532402927647951.pcd.bin",
                           "n015-2018-07-24-11-22-45+0800__LIDAR_TOP__1532402928147847.pcd.bin"},
                          "us",
                          1'532'402'927'647'951'000,
                          499'896'000},
                      NameCase{{"lidar-1567496784952532897.ply", "lidar-1567496785052532897.ply"},
                               "ns",
                               1'567'496'784'952'532'897,
                               100'000'000},
                      NameCase{{"cloud_1583840211_83000000.pcd", "cloud_1583840211_183000000.pcd"},
                               "s_ns",
                               1'583'840'211'083'000'000,
                               100'000'000}));

TEST(NameStamps, NumbersAndImpossibleDatesAreNone) {
  for (const auto& names :
       std::vector<std::vector<std::string>>{{"scan0.bin", "scan1.bin"},
                                             {"2021-13-26-16-21-29.pcd", "2021-13-26-16-21-30.pcd"},
                                             {"2021-10-26-16-21-29.pcd", "scan.pcd"},
                                             {"000001.bin", "a__1532402927647951.bin"},
                                             {"000001.bin", "1532402927647951.bin"}}) {
    std::vector<fs::path> files(names.begin(), names.end());
    EXPECT_FALSE(recordings::stamps_from_names(files)) << names.front();
  }
}

}  // namespace
}  // namespace groundloop
