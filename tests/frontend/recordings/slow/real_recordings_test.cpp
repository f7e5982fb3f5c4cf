// Real files of many sensors, opened as a user would, against what is known of them. One test,
// since the recordings are unpacked once.
#include "tests/support/real_recordings.hpp"

#include <algorithm>
#include <cmath>
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
}

}  // namespace
}  // namespace groundloop
