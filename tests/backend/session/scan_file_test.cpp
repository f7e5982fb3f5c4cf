#include "backend/session/scan_file.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::TemporaryFolder;

KeptScan some_scan(std::uint32_t number, float reach, std::size_t points, float largest) {
  std::mt19937 generator(number);
  std::uniform_real_distribution<float> place(-reach, reach), strength(0.0F, largest);
  KeptScan scan{number, {}, {}};
  for (std::size_t i = 0; i < points; ++i) {
    scan.points.emplace_back(place(generator), place(generator), place(generator));
    if (largest > 0.0F) scan.intensity.push_back(strength(generator));
  }
  return scan;
}

TEST(ScanFile, KeepsPointsWithinHalfAStep) {
  const TemporaryFolder folder;
  const KeptScan near = some_scan(3, 100.0F, 1000, 0.0F);
  const KeptScan far = some_scan(7, 300.0F, 1000, 0.0F);
  ScanFileBuilder builder;
  builder.add(near);
  builder.add(far);
  builder.write(folder / "0.bin");
  EXPECT_EQ(builder.scans(), 0U) << "written is forgotten";
  // Two heads of 24 and 16 bytes, six bytes a point: no more.
  EXPECT_EQ(std::filesystem::file_size(folder / "0.bin"), 24U + 2 * 16 + 2 * 6000);
  const std::vector<KeptScan> read = read_scan_file(folder / "0.bin");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].scan, 3U);
  EXPECT_EQ(read[1].scan, 7U);
  EXPECT_TRUE(read[0].intensity.empty());
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_LE((read[0].points[i] - near.points[i]).cwiseAbs().maxCoeff(), 0.5F / 256 + 1e-5F);
    // 300 m are 32767 steps of 1/64 m, not of 1/128.
    EXPECT_LE((read[1].points[i] - far.points[i]).cwiseAbs().maxCoeff(), 0.5F / 64 + 1e-4F);
  }
}

TEST(ScanFile, KeepsIntensities) {
  const TemporaryFolder folder;
  ScanFileBuilder builder;
  const KeptScan shares = some_scan(0, 10.0F, 500, 1.0F);
  KeptScan counts = some_scan(1, 10.0F, 256, 255.0F);
  KeptScan many = some_scan(2, 10.0F, 500, 40000.0F);
  for (std::size_t i = 0; i < 256; ++i) counts.intensity[i] = static_cast<float>(i);
  many.intensity[5] = 1e9F;
  many.intensity[6] = -3.0F;
  many.intensity[7] = std::numeric_limits<float>::quiet_NaN();
  builder.add(shares);
  builder.add(counts);
  builder.add(many);
  builder.write(folder / "0.bin");
  const std::vector<KeptScan> read = read_scan_file(folder / "0.bin");
  for (std::size_t i = 0; i < 500; ++i)
    EXPECT_NEAR(read[0].intensity[i], shares.intensity[i], 1.0 / 65535);
  EXPECT_EQ(read[1].intensity, counts.intensity);
  EXPECT_NEAR(read[2].intensity[0], many.intensity[0], 0.5);
  EXPECT_EQ(read[2].intensity[5], 65535.0F);
  EXPECT_EQ(read[2].intensity[6], 0.0F);
  EXPECT_EQ(read[2].intensity[7], 0.0F);
  EXPECT_EQ(largest_intensity_of(folder / "0.bin"), 65535.0F);
}

TEST(ScanFile, LeavesOutWhatIsNoPoint) {
  const TemporaryFolder folder;
  const float none = std::numeric_limits<float>::quiet_NaN();
  ScanFileBuilder builder;
  builder.add({4, {{1, 2, 3}, {none, 0, 0}, {0, 1e7F, 0}, {4, 5, 6}}, {0.25F, 9, 9, 0.5F}});
  builder.write(folder / "0.bin");
  const KeptScan scan = read_scan_file(folder / "0.bin").front();
  EXPECT_EQ(scan.points, (Points{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(scan.intensity, (std::vector<float>{0.25F, 0.5F}));
}

TEST(ScanFile, GoesOnFromItsState) {
  const TemporaryFolder folder;
  ScanFileBuilder whole, first, second;
  whole.add(some_scan(1, 50.0F, 100, 255.0F));
  first.add(some_scan(1, 50.0F, 100, 255.0F));
  std::stringstream state;
  first.save(state);
  second.load(state);
  whole.add(some_scan(2, 50.0F, 100, 0.0F));
  second.add(some_scan(2, 50.0F, 100, 0.0F));
  whole.write(folder / "whole.bin");
  second.write(folder / "second.bin");
  EXPECT_EQ(read_text(folder / "whole.bin"), read_text(folder / "second.bin"));
}

// The bytes under a right checksum, as somebody who means harm would write them.
void write_sealed(const std::filesystem::path& file, std::string bytes) {
  if (bytes.size() >= 16) {
    const std::uint64_t sum = checksum(std::string_view(bytes).substr(16));
    std::memcpy(bytes.data() + 8, &sum, sizeof sum);
  }
  write_text_atomically(file, bytes);
}

TEST(ScanFile, RefusesWhatIsDamagedOrCutOff) {
  const TemporaryFolder folder;
  ScanFileBuilder builder;
  builder.add(some_scan(1, 50.0F, 20, 1.0F));
  builder.add(some_scan(2, 50.0F, 20, 1.0F));
  builder.write(folder / "whole.bin");
  const std::string whole = read_text(folder / "whole.bin");
  const auto file = folder / "damaged.bin";
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write_sealed(file, whole.substr(0, length));
    EXPECT_THROW((void)read_scan_file(file), InputError) << length;
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    write_text_atomically(file, changed);
    EXPECT_THROW((void)read_scan_file(file), InputError) << i;
  }
  write_sealed(file, whole + "x");
  EXPECT_THROW((void)read_scan_file(file), InputError);
  EXPECT_THROW((void)read_scan_file(folder / "absent.bin"), InputError);
  EXPECT_THROW((void)largest_intensity_of(folder / "absent.bin"), InputError);
}

TEST(ScanFile, RefusesScansOutOfOrderAndCountsBeyondTheFile) {
  const TemporaryFolder folder;
  ScanFileBuilder builder;
  builder.add(some_scan(5, 50.0F, 20, 0.0F));
  builder.add(some_scan(5, 50.0F, 20, 0.0F));
  builder.write(folder / "twice.bin");
  EXPECT_THROW((void)read_scan_file(folder / "twice.bin"), InputError);
  builder.add(some_scan(5, 50.0F, 20, 0.0F));
  builder.write(folder / "whole.bin");
  const std::string whole = read_text(folder / "whole.bin");
  const auto with = [&](std::size_t at, std::uint32_t value) {
    std::string changed = whole;
    std::memcpy(changed.data() + at, &value, sizeof value);
    write_sealed(folder / "changed.bin", changed);
    return folder / "changed.bin";
  };
  EXPECT_EQ(read_scan_file(with(24, 6)).front().scan, 6U);                // the place is right
  EXPECT_THROW((void)read_scan_file(with(16, 0xffffffffU)), InputError);  // scans
  EXPECT_THROW((void)read_scan_file(with(28, 0xffffffffU)), InputError);  // points
  EXPECT_THROW((void)read_scan_file(with(32, 0x7fc00000U)),
               InputError);  // a step that is no number
  EXPECT_THROW((void)read_scan_file(with(32, 0x3f000001U)), InputError);  // no power of two
  EXPECT_THROW((void)largest_intensity_of(with(20, 0x7fc00000U)), InputError);
}

}  // namespace
}  // namespace groundloop
