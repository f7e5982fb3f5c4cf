// Readers on damaged files: bytes changed, cut, repeated and lengthened at random (always the same
// way). Whatever comes, a reader answers with a scan or with InputError; under the sanitizers'
// presets it also touches no memory that is not its own.
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/point_cloud2.hpp"
#include "frontend/recordings/point_files.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "tests/support/point_cloud2_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2654435761U + 1) {}
  std::size_t below(std::size_t n) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>((state_ >> 33U) % n);
  }

 private:
  std::uint64_t state_;
};

std::string mutate(std::string bytes, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t change = 0, changes = 1 + random.below(4); change < changes; ++change) {
    if (bytes.empty()) return bytes;
    // Half of the changes fall on the front, where headers are.
    const std::size_t reach =
        random.below(2) == 0 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
    const std::size_t at = random.below(reach);
    switch (random.below(6)) {
      case 0:
        bytes[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, 1 + random.below(40)));
        break;
      case 4:
        bytes.erase(at, 1 + random.below(16));
        break;
      default:
        for (std::size_t i = at; i < std::min(at + 4, bytes.size()); ++i) bytes[i] = '\xff';
    }
  }
  return bytes;
}

// Runs f; only InputError may come out.
template <typename F>
void survives(F&& f, std::uint64_t seed) {
  try {
    f();
  } catch (const InputError&) {
  } catch (const std::exception& e) {
    ADD_FAILURE() << "seed " << seed << ": " << e.what();
  }
}

void read_all(const fs::path& path) {
  const auto recording = open_recording(path.string());
  for (std::size_t i = 0; i < recording->size(); ++i) (void)recording->read(i);
}

// Two small scans with times.
class Small final : public Recording {
 public:
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return 2; }
  Nanoseconds stamp(std::size_t index) const override {
    return 1'700'000'000'000'000'000 + static_cast<Nanoseconds>(index) * 100'000'000;
  }
  Scan read(std::size_t index) override {
    Scan scan;
    scan.stamp = stamp(index);
    for (int i = 0; i < 20; ++i) {
      scan.points.emplace_back(static_cast<float>(i + 1), 2.0F, 3.0F);
      scan.times.push_back(0.004F * static_cast<float>(i));
    }
    return scan;
  }

 private:
  RecordingInfo info_;
};

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class DamagedLayout : public ::testing::TestWithParam<const char*> {};

TEST_P(DamagedLayout, GivesScansOrInputError) {
  testing::TemporaryFolder folder;
  Small small;
  const fs::path out = folder / "out";
  write_layout(small, GetParam(), out);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const std::string whole = content_of(file);
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      testing::write_file(file, mutate(whole, seed));
      survives([&] { read_all(out); }, seed);
    }
    testing::write_file(file, whole);
  }
  EXPECT_NO_THROW(read_all(out));
}

INSTANTIATE_TEST_SUITE_P(All, DamagedLayout,
                         ::testing::Values("kitti", "mulran", "helipr", "nclt", "rosbag", "rosbag2",
                                           "mcap", "folder"));

TEST(DamagedBytes, OfPointCloud2GiveACloudOrInputError) {
  const testing::CloudSpec spec;
  for (std::uint64_t seed = 0; seed < 20'000; ++seed) {
    const bool cdr = seed % 2 == 0;
    const std::string message =
        mutate(cdr ? testing::cdr_cloud(spec, seed % 4 == 0) : testing::ros1_cloud(spec), seed);
    const auto bytes = std::as_bytes(std::span(message.data(), message.size()));
    const auto encoding = cdr ? recordings::Encoding::cdr : recordings::Encoding::ros1;
    survives(
        [&] {
          (void)recordings::parse_cloud_header(bytes, encoding);
          const recordings::Cloud cloud = recordings::parse_cloud(bytes, encoding, "message");
          const auto times = recordings::infer_time_model(
              cloud.table.layout, cloud.data, cloud.table.count, cloud.header.stamp, 100'000'000);
          (void)recordings::decode_points(cloud.table.layout, cloud.data, cloud.table.count,
                                          cloud.header.stamp, times, "message");
        },
        seed);
  }
}

TEST(DamagedBytes, OfPcdAndPlyGivePointsOrInputError) {
  testing::Bytes compressed, little, ascii;
  compressed.text(
      "VERSION 0.7\nFIELDS x y z t\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "POINTS 2\nDATA binary_compressed\n");
  compressed.put(std::uint32_t{33}).put(std::uint32_t{32}).put(std::uint8_t{31});
  compressed.floats(1, -4.5, 2, 0.25, 3, 6, 0, 1);
  little.text(
      "ply\nformat binary_little_endian 1.0\nelement camera 1\nproperty int id\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\nproperty double t\nend_header\n");
  little.put(std::int32_t{7}).floats(1, 2, 3).put(0.0).floats(4, 5, 6).put(0.1);
  ascii.text(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty uint t\nend_header\n1 2 3 0\n-4.5 0.25 6 50000000\n");
  for (std::uint64_t seed = 0; seed < 20'000; ++seed) {
    const testing::Bytes* seeds[] = {&compressed, &little, &ascii};
    const std::string file = mutate(seeds[seed % 3]->str(), seed);
    const auto view = std::as_bytes(std::span(file.data(), file.size()));
    std::vector<std::byte> bytes(view.begin(), view.end());
    survives(
        [&] {
          const recordings::PointTable table = seed % 3 == 0 ? recordings::parse_pcd(bytes, "file")
                                                             : recordings::parse_ply(bytes, "file");
          const auto times =
              recordings::infer_time_model(table.layout, bytes, table.count, 0, 100'000'000);
          (void)recordings::decode_points(table.layout, bytes, table.count, 0, times, "file");
        },
        seed);
  }
}

}  // namespace
}  // namespace groundloop
