// Real files of many sensors, opened as a user would, against what is known of them. One test,
// since the recordings are unpacked once.
#include "tests/support/real_recordings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/recordings/recording.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::unique_ptr<Recording> open(const fs::path& path, const fs::path& calibration = {}) {
  RecordingOptions options;
  options.calibration = calibration.string();
  options.attributes = AttributeSet::all();
  return open_recording(path.string(), options);
}

Points read_all(Recording& recording) {
  Points points;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const Scan scan = recording.read(i);
    points.insert(points.end(), scan.points.begin(), scan.points.end());
  }
  return points;
}

// Share of the reference's points that are there, to a tenth of a millimetre in range and height
// and to `azimuth_deg` around.
double share_found(Points points, const Points& reference, double azimuth_deg) {
  constexpr double kMillimetre = 1e-3;
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.z() < b.z(); });
  std::size_t found = 0;
  for (const Eigen::Vector3f& r : reference) {
    auto it = std::lower_bound(points.begin(), points.end(), r.z() - 1e-4F,
                               [](const Eigen::Vector3f& p, float z) { return p.z() < z; });
    const double around =
        1e-4 + static_cast<double>(r.norm()) * azimuth_deg * std::numbers::pi / 180.0;
    for (; it != points.end() && it->z() <= r.z() + 1e-4F; ++it) {
      if (std::abs(static_cast<double>(it->norm() - r.norm())) > 0.1 * kMillimetre) continue;
      if (static_cast<double>((*it - r).norm()) > around) continue;
      ++found;
      break;
    }
  }
  return static_cast<double>(found) / static_cast<double>(reference.size());
}

struct PacketCase {
  const char* folder;
  const char* calibration;
  const char* sensor;
  // The references round azimuths to 0.01 degrees, and turn Velodyne's beams with their block
  // (VLP-32C, VLS-128) or not at all in the last block of a packet (VLP-16): up to one block's
  // turn.
  double azimuth_deg;
};

void expect_reference(const fs::path& packets, const PacketCase& c) {
  SCOPED_TRACE(c.folder);
  fs::path bag, pcd;
  for (const auto& entry : fs::directory_iterator(packets / "nebula" / c.folder))
    (entry.is_directory() ? bag : pcd) = entry.path();
  const fs::path calibration =
      *c.calibration == '\0' ? fs::path() : packets / "nebula" / "calibration" / c.calibration;
  const auto recording = open(bag, calibration);
  EXPECT_THAT(recording->info().sensor, HasSubstr(c.sensor));
  const fs::path alone = fs::path(GROUNDLOOP_TEST_WORK) / "reference" / c.folder;
  fs::create_directories(alone);
  fs::copy_file(pcd, alone / pcd.filename(), fs::copy_options::overwrite_existing);
  const Points reference = open(alone)->read(0).points;
  ASSERT_GT(reference.size(), 10'000U);
  // All but what the recording's ends cut off.
  EXPECT_GT(share_found(read_all(*recording), reference, c.azimuth_deg), 0.995);
}

// The image of ranges in millimetres, beams by columns, put together again from the decoded points
// of a sensor with one return.
std::vector<std::uint32_t> range_image(const Scan& scan, std::size_t rows, double beam_offset,
                                       double height) {
  constexpr std::size_t kColumns = 1024;
  // Both outer columns have returns; between them columns are evenly spaced to a fifth of a step.
  const auto [first, last] = std::minmax_element(scan.times.begin(), scan.times.end());
  const double step = static_cast<double>(*last - *first) / (kColumns - 1);
  std::vector<std::uint32_t> image(rows * kColumns, 0);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto column =
        static_cast<std::size_t>(std::lround(static_cast<double>(scan.times[i] - *first) / step));
    const double encoder = -2.0 * std::numbers::pi * static_cast<double>(column) / kColumns;
    // Half a turn about z brings the sensor's frame to the lidar's; beams begin beside the axis.
    const Eigen::Vector3d p(-static_cast<double>(scan.points[i].x()),
                            -static_cast<double>(scan.points[i].y()),
                            static_cast<double>(scan.points[i].z()) - height);
    const Eigen::Vector3d beam =
        p - beam_offset * Eigen::Vector3d(std::cos(encoder), std::sin(encoder), 0.0);
    image[(rows - 1 - scan.attributes.ring[i]) * kColumns + column] =
        static_cast<std::uint32_t>(std::lround(1e3 * (beam.norm() + beam_offset)));
  }
  return image;
}

// By the program that every system has.
std::string md5(const std::vector<std::uint32_t>& image) {
  const fs::path file = fs::path(GROUNDLOOP_TEST_WORK) / "range_image.bin";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(image.data()),
             static_cast<std::streamsize>(image.size() * sizeof(image[0])));
  std::FILE* pipe = ::popen(("md5sum '" + file.string() + "'").c_str(), "r");
  if (pipe == nullptr) return {};
  std::array<char, 33> text{};
  const std::size_t got = std::fread(text.data(), 1, 32, pipe);
  ::pclose(pipe);
  return {text.data(), got};
}

TEST(RealRecordings, AreReadAsWhatTheyAre) {
  const fs::path real = testing::real_recordings();
  if (real.empty()) GTEST_SKIP() << "the recordings are absent from " GROUNDLOOP_SHARED_DATA;
  const fs::path packets = real / "packets";
  for (const PacketCase& c :
       {PacketCase{"40p", "Pandar40P.csv", "Pandar40P, 40 beams, dual returns", 0.0},
        PacketCase{"xt32", "PandarXT32.csv", "PandarXT-32, 32 beams, dual returns", 0.0},
        PacketCase{"qt64", "PandarQT64.csv", "PandarQT64, 64 beams, dual returns", 0.0},
        PacketCase{"vlp16", "VLP16.yaml", "VLP-16, 16 beams, dual returns", 0.45},
        PacketCase{"vlp32", "VLP32.yaml", "VLP-32C, 32 beams, one return", 0.25},
        PacketCase{"vls128", "VLS128.yaml", "VLS-128, 128 beams, one return", 0.25}})
    expect_reference(packets, c);

  // The digest of the field RANGE that stands beside the capture, to the last bit.
  const auto os2 = open(packets / "ouster" / "OS-2-32-U0_v2.0.0_1024x10.pcap");
  EXPECT_EQ(md5(range_image(os2->read(0), 32, 0.013762, 0.074296)),
            "fb18f696ae1d06fac0368135a3eb89a9");
  // Fields RANGE and RANGE2, whose digests stand beside it, hold 21 631 and 172 returns.
  const auto os0 = open(packets / "ouster" / "OS-0-32-U1_v2.2.0_1024x10.pcap");
  EXPECT_EQ(os0->read(0).points.size(), 21'631U + 172U);

  // A Robosense E1 counts milliseconds.
  EXPECT_THAT(open(real / "robosense_pcd" / "e1")->info().point_times,
              HasSubstr("field 'time_stamp' (uint32), ms from the first point"));
  // nuScenes: five values, the last a ring, in files that fit records of four.
  const auto nuscenes = open(real / "nuscenes_keyframes");
  EXPECT_EQ(nuscenes->info().fields.back(), "ring float32");
  const Scan scan = nuscenes->read(3);
  EXPECT_EQ(*std::max_element(scan.attributes.ring.begin(), scan.attributes.ring.end()), 31);
}

}  // namespace
}  // namespace groundloop
