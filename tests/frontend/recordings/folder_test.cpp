// Folders of scans: PCD and PLY in every form, headerless files, stamps and per-point times.
#include <cmath>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/lzf.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::Bytes;
using ::testing::HasSubstr;
using testing::write_file;

class Folder : public ::testing::Test {
 protected:
  std::unique_ptr<Recording> open() { return open_recording(folder_.path().string()); }
  std::string error_of_reading() {
    try {
      const auto recording = open();
      for (std::size_t i = 0; i < recording->size(); ++i) (void)recording->read(i);
    } catch (const InputError& e) {
      EXPECT_THAT(std::string(e.what()), ::testing::Not(HasSubstr("\n")));
      return e.what();
    }
    return "none";
  }
  void expect_two_points(const Scan& scan) {
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points[0], Eigen::Vector3f(1, 2, 3));
    EXPECT_EQ(scan.points[1], Eigen::Vector3f(-4.5F, 0.25F, 6));
  }
  testing::TemporaryFolder folder_;
};

std::string pcd_header(const std::string& fields, const std::string& sizes,
                       const std::string& types, int points, const std::string& data) {
  const std::string n = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " +
         sizes + "\nTYPE " + types + "\nCOUNT 1 1 1 1\nWIDTH " + n +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + data + "\n";
}

TEST_F(Folder, ReadsPcdAscii) {
  write_file(folder_ / "0.pcd", pcd_header("x y z t", "4 4 4 4", "F F F F", 3, "ascii") +
                                    "1 2 3 0\nnan nan nan 0.03\n-4.5 0.25 6 0.05\n");
  const auto recording = open();
  EXPECT_EQ(recording->info().format, "folder");
  EXPECT_THAT(recording->info().point_times, HasSubstr("field 't' (float32), s from the stamp"));
  const Scan scan = recording->read(0);
  expect_two_points(scan);
  EXPECT_FLOAT_EQ(scan.times[1], 0.05F);
}

TEST_F(Folder, ReadsPcdBinaryWithDoublesAndIntegerTimes) {
  Bytes file;
  file.text(pcd_header("x y z offset_time", "8 8 8 4", "F F F U", 2, "binary"));
  file.put(1.0).put(2.0).put(3.0).put(std::uint32_t{0});
  file.put(-4.5).put(0.25).put(6.0).put(std::uint32_t{98'765'432});
  write_file(folder_ / "0.pcd", file);
  const auto recording = open();
  EXPECT_THAT(recording->info().point_times, HasSubstr("field 'offset_time' (uint32), ns"));
  const Scan scan = recording->read(0);
  expect_two_points(scan);
  EXPECT_NEAR(scan.times[1], 0.098765432, 1e-8);
}

TEST_F(Folder, ReadsPcdBinaryCompressed) {
  // Columns: x x y y z z i i, here as one literal run of 32 bytes (control byte 31).
  Bytes file;
  file.text(pcd_header("x y z intensity", "4 4 4 4", "F F F F", 2, "binary_compressed"));
  file.put(std::uint32_t{33}).put(std::uint32_t{32}).put(std::uint8_t{31});
  file.floats(1, -4.5, 2, 0.25, 3, 6, 0, 0);
  write_file(folder_ / "0.pcd", file);
  expect_two_points(open()->read(0));
}

TEST_F(Folder, ReadsPcdFieldsOfSeveralValues) {
  Bytes file;
  file.text(
      "VERSION 0.7\nFIELDS x y z normal\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 3\n"
      "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n");
  file.floats(1, 2, 3, 7, 7, 7, -4.5, 0.25, 6, 8, 8, 8);
  write_file(folder_ / "0.pcd", file);
  expect_two_points(open()->read(0));
}

TEST(Lzf, DecompressesReferencesThatOverlap) {
  // Literal "ab", then 6 bytes from 2 back (length code 4), then 10 from 1 back (code 7 + 1).
  const std::vector<std::uint8_t> in = {1, 'a', 'b', (4U << 5U) | 0, 1, (7U << 5U) | 0, 1, 0};
  std::vector<std::byte> out(18);
  ASSERT_TRUE(recordings::lzf_decompress(std::as_bytes(std::span(in)), out));
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(out.data()), out.size()),
            "abababab" + std::string(10, 'b'));
  EXPECT_FALSE(recordings::lzf_decompress(std::as_bytes(std::span(in)).first(4), out));
  std::vector<std::byte> longer(19);
  EXPECT_FALSE(recordings::lzf_decompress(std::as_bytes(std::span(in)), longer));
}

TEST(Lzf, RoundTrips) {
  std::vector<std::byte> data;
  for (std::uint32_t i = 0; i < 30'000; ++i) {
    data.push_back(static_cast<std::byte>((i / 100) * (i % 7 == 0 ? i : 3)));
  }
  const std::vector<std::byte> packed = recordings::lzf_compress(data);
  EXPECT_LT(packed.size(), data.size());
  std::vector<std::byte> out(data.size());
  ASSERT_TRUE(recordings::lzf_decompress(packed, out));
  EXPECT_EQ(out, data);
}

TEST_F(Folder, ReadsPlyAscii) {
  write_file(folder_ / "0.ply",
             "ply\nformat ascii 1.0\ncomment made by hand\nelement camera 1\nproperty int id\n"
             "element vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
             "property uint t\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
             "17\n1 2 3 0\n-4.5 0.25 6 50000000\n");
  const Scan scan = open()->read(0);
  expect_two_points(scan);
  EXPECT_NEAR(scan.times[1], 0.05, 1e-9);
}

TEST_F(Folder, ReadsPlyOfBothEndians) {
  const std::string properties =
      "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property double timestamp\nend_header\n";
  Bytes little, big;
  little.text("ply\nformat binary_little_endian 1.0\n" + properties);
  little.floats(1, 2, 3).put(12.5).floats(-4.5, 0.25, 6).put(12.59);
  big.text("ply\nformat binary_big_endian 1.0\n" + properties);
  big.put_big(1.0F).put_big(2.0F).put_big(3.0F).put_big(12.5);
  big.put_big(-4.5F).put_big(0.25F).put_big(6.0F).put_big(12.59);
  for (const Bytes* file : {&little, &big}) {
    write_file(folder_ / "12.5.ply", *file);
    const auto recording = open();
    EXPECT_THAT(recording->info().point_times, HasSubstr("absolute"));
    const Scan scan = recording->read(0);
    expect_two_points(scan);
    EXPECT_NEAR(scan.times[0], 0.0, 1e-9);
    EXPECT_NEAR(scan.times[1], 0.09, 1e-7);
  }
}

TEST_F(Folder, WrongEndiannessLeavesNoValidPoint) {
  Bytes file;  // little-endian values under a big-endian header: coordinates beyond all measure
  file.text(
      "ply\nformat binary_big_endian 1.0\nelement vertex 2\nproperty double x\n"
      "property double y\nproperty double z\nend_header\n");
  for (int i = 0; i < 6; ++i) file.put(1.1 + i);
  write_file(folder_ / "0.ply", file);
  EXPECT_THAT(error_of_reading(), HasSubstr("none of its 2 points is valid"));
}

// Absolute times of 64-bit nanoseconds lose nothing to a double.
TEST_F(Folder, KeepsNanosecondsOfAbsoluteTimes) {
  Bytes file;
  file.text(pcd_header("x y z timestamp", "4 4 4 8", "F F F U", 2, "binary"));
  file.floats(1, 2, 3).put(std::uint64_t{1'567'496'784'952'532'897});
  file.floats(-4.5, 0.25, 6).put(std::uint64_t{1'567'496'785'050'000'001});
  write_file(folder_ / "1567496784952532897.pcd", file);
  const auto recording = open();
  EXPECT_EQ(recording->info().stamp_source, "file names (ns)");
  EXPECT_EQ(recording->stamp(0), 1'567'496'784'952'532'897);
  EXPECT_NEAR(recording->read(0).times[1], 0.097467104, 1e-8);
}

struct TimeCase {
  const char* field;
  double scale;      // units a second
  double offset_s;   // of the clock
  const char* text;  // expected in the description
};
class FolderTimes : public Folder, public ::testing::WithParamInterface<TimeCase> {};

// 0 to 90 ms in every unit, relative and absolute, to a stamp of 1.6e9 s.
TEST_P(FolderTimes, AreRecognised) {
  const TimeCase c = GetParam();
  for (int s = 0; s < 2; ++s) {
    Bytes file;
    file.text(pcd_header("x y z " + std::string(c.field), "4 4 4 8", "F F F F", 2, "binary"));
    const double start = c.offset_s == 0.0 ? 0.0 : c.offset_s + 0.1 * s;
    file.floats(1, 2, 3).put(start * c.scale);
    file.floats(-4.5, 0.25, 6).put((start + 0.09) * c.scale);
    write_file(folder_ / (std::to_string(16'000'000'000 + s) + "00000000.pcd"), file);
  }
  const auto recording = open();
  EXPECT_THAT(recording->info().point_times, HasSubstr(c.text));
  const Scan scan = recording->read(1);
  EXPECT_NEAR(scan.times[0], 0.0, 2e-6) << recording->info().point_times;
  EXPECT_NEAR(scan.times[1], 0.09, 2e-6);
}

INSTANTIATE_TEST_SUITE_P(Units, FolderTimes,
                         ::testing::Values(TimeCase{"t", 1, 0, "s from the stamp"},
                                           TimeCase{"time", 1e3, 0, "ms from the stamp"},
                                           TimeCase{"offset_time", 1e6, 0, "us from the stamp"},
                                           TimeCase{"t", 1e9, 0, "ns from the stamp"},
                                           TimeCase{"timestamp", 1, 1.6e9, "s, absolute"},
                                           TimeCase{"time_stamp", 1e6, 1.6e9, "us, absolute"},
                                           TimeCase{"timestamp", 1e9, 1.6e9, "ns, absolute"},
                                           TimeCase{"timestamp", 1, 5000, "from the first point"},
                                           TimeCase{"timestamps", 10, 0, "share of the scan"}));

TEST_F(Folder, DropsPointsWhoseTimeIsNaN) {
  write_file(folder_ / "0.pcd", pcd_header("x y z t", "4 4 4 4", "F F F F", 3, "ascii") +
                                    "1 2 3 0\n7 7 7 nan\n-4.5 0.25 6 0.05\n");
  const Scan scan = open()->read(0);
  expect_two_points(scan);
  EXPECT_EQ(scan.times.size(), 2U);
}

TEST_F(Folder, ConstantTimesAreNone) {
  write_file(folder_ / "0.pcd",
             pcd_header("x y z t", "4 4 4 4", "F F F F", 2, "ascii") + "1 2 3 5\n4 5 6 5\n");
  const auto recording = open();
  EXPECT_THAT(recording->info().point_times, HasSubstr("constant"));
  EXPECT_TRUE(recording->read(0).times.empty());
}

TEST_F(Folder, ReadsBinInNaturalOrderAtTenHertz) {
  for (const int i : {10, 9, 100}) {
    write_file(folder_ / ("scan" + std::to_string(i) + ".bin"), Bytes().floats(i, 1, 1, 0));
  }
  const auto recording = open();
  EXPECT_EQ(recording->info().stamp_source, "assumed 10 Hz");
  EXPECT_THAT(recording->info().notes.back(), HasSubstr("10 scans a second are assumed"));
  EXPECT_EQ(recording->read(0).points[0].x(), 9.0F);
  EXPECT_EQ(recording->read(1).points[0].x(), 10.0F);
  EXPECT_EQ(recording->read(2).points[0].x(), 100.0F);
  EXPECT_EQ(recording->stamp(2), 200'000'000);
}

TEST_F(Folder, ReadsRecordsOfSixFloats) {  // Boreas: x y z intensity laser t
  for (int i = 0; i < 3; ++i) {
    write_file(folder_ / (std::to_string(1'606'417'097'528'152 + 100'000 * i) + ".bin"),
               Bytes().floats(1, 2, 3, 9, 5, 0.01, -4.5, 0.25, 6, 9, 7, 0.09, 1, 1, 1, 1, 1, 0.1));
  }
  const auto recording = open();
  EXPECT_EQ(recording->info().stamp_source, "file names (us)");
  const Scan scan = recording->read(1);
  ASSERT_EQ(scan.points.size(), 3U);
  EXPECT_FLOAT_EQ(scan.times[1], 0.09F);
}

TEST_F(Folder, TakesStampsFromTimesAndNames) {
  write_file(folder_ / "a.bin", Bytes().floats(1, 1, 1, 0));
  write_file(folder_ / "b.bin", Bytes().floats(1, 1, 1, 0));
  write_file(folder_ / "times.txt", "5.25\n5.5\n");
  EXPECT_EQ(open()->stamp(1), 5'500'000'000);
  fs::remove(folder_ / "times.txt");
  fs::rename(folder_ / "a.bin", folder_ / "cloud_1583840211_83000000.bin");
  fs::rename(folder_ / "b.bin", folder_ / "cloud_1583840211_183000000.bin");
  EXPECT_EQ(open()->stamp(0), 1'583'840'211'083'000'000);
  fs::rename(folder_ / "cloud_1583840211_83000000.bin", folder_ / "1.05.bin");
  fs::rename(folder_ / "cloud_1583840211_183000000.bin", folder_ / "1.1.bin");
  EXPECT_EQ(open()->stamp(0), 1'050'000'000);  // by value, not by natural order
  fs::rename(folder_ / "1.05.bin", folder_ / "0.bin");
  fs::rename(folder_ / "1.1.bin", folder_ / "100000000.bin");
  EXPECT_EQ(open()->stamp(1), 100'000'000);
}

TEST_F(Folder, TakesGroundTruthInTumAndKittiForm) {
  write_file(folder_ / "a.bin", Bytes().floats(1, 1, 1, 0));
  write_file(folder_ / "b.bin", Bytes().floats(1, 1, 1, 0));
  write_file(folder_ / "ground_truth.txt", "# stamp x y z qx qy qz qw\n0.05 1 2 3 0 0 0 1\n");
  EXPECT_EQ(open()->ground_truth()[0].stamp, 50'000'000);
  write_file(folder_ / "ground_truth.txt", "1 0 0 5 0 1 0 6 0 0 1 7\n1 0 0 5 0 1 0 6 0 0 1 8\n");
  EXPECT_EQ(open()->ground_truth()[1].pose.translation.z(), 8.0);
  write_file(folder_ / "ground_truth.txt", "1 0 0 5 0 1 0 6 0 0 1 7\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("1 poses for 2 scans"));
  write_file(folder_ / "ground_truth.txt", "1 2 3\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("3 columns"));
}

TEST_F(Folder, NamesWhatIsWrongWithPcd) {
  const auto expect = [&](const std::string& content, const char* text) {
    write_file(folder_ / "0.pcd", content);
    EXPECT_THAT(error_of_reading(), HasSubstr(text));
  };
  const std::string floats(31, 'x');
  expect(pcd_header("x y z i", "4 4 4 4", "F F F F", 2, "binary") + floats, "31 of 32 bytes");
  expect(pcd_header("x y w i", "4 4 4 4", "F F F F", 1, "binary") + floats, "no field 'z'");
  expect(pcd_header("x y z i", "4 4 2 4", "F F F F", 1, "binary") + floats, "none that PCD knows");
  expect(pcd_header("x y z i", "4 4 4 4", "F F I F", 1, "binary") + floats, "all float32");
  expect(pcd_header("x y z", "4 4 4", "F F F", 1, "binary") + floats, "differ in length");
  expect(pcd_header("x y z i", "4 4 4 4", "F F F F", 1, "zip") + floats, "DATA zip is unknown");
  expect(pcd_header("x y z i", "4 4 4 4", "F F F F", 2, "ascii") + "1 2 3 4\n5 6\n",
         "ends after 1 of 2 points");
  expect(pcd_header("x y z i", "4 4 4 4", "F F F F", 1, "ascii") + "1 two 3 4\n", "'two'");
  expect(pcd_header("x y z i", "4 4 4 4", "F F F F", 2'000'000'000, "ascii") + "1\n", "announced");
  expect(
      "VERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
      "WIDTH 9999999999999\nHEIGHT 9999999999999\nDATA binary\n",
      "absurd");
  expect("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n", "no line DATA");
  expect("", "no line DATA");
  expect(pcd_header("x y z i", "4 4 4 4", "F F F F", 0, "binary"), "holds no point");
  Bytes packed;
  packed.text(pcd_header("x y z i", "4 4 4 4", "F F F F", 2, "binary_compressed"));
  packed.put(std::uint32_t{33}).put(std::uint32_t{32}).put(std::uint8_t{31}).floats(1, 2, 3);
  expect(packed.str(), "13 of 33 compressed bytes");
  Bytes broken;
  broken.text(pcd_header("x y z i", "4 4 4 4", "F F F F", 2, "binary_compressed"));
  broken.put(std::uint32_t{3}).put(std::uint32_t{32}).put(std::uint8_t{0xff}).text("ab");
  expect(broken.str(), "compressed data are broken");
}

TEST_F(Folder, NamesWhatIsWrongWithPly) {
  const auto expect = [&](const std::string& content, const char* text) {
    write_file(folder_ / "0.ply", content);
    EXPECT_THAT(error_of_reading(), HasSubstr(text));
  };
  const std::string xyz = "property float x\nproperty float y\nproperty float z\nend_header\n";
  expect("plx\n", "does not begin with 'ply'");
  expect("ply\nformat ascii 1.0\nelement vertex 1\n", "no end_header");
  expect("ply\nformat binary_middle_endian 1.0\nelement vertex 1\n" + xyz, "is unknown");
  expect("ply\nformat binary_little_endian 1.0\nelement vertex 2\n" + xyz + "123456789", "cut off");
  expect("ply\nformat ascii 1.0\nelement point 1\n" + xyz + "1 2 3\n", "no element 'vertex'");
  expect("ply\nformat ascii 1.0\nelement vertex -1\n" + xyz, "no whole number");
}

TEST_F(Folder, NamesTheOneBinThatIsCutOffAmongRecordsOfFiveValues) {
  write_file(folder_ / "0.bin", Bytes().floats(1, 2, 3, 4, 5));
  write_file(folder_ / "1.bin", Bytes().floats(1, 2, 3, 4, 5, 1, 2, 3, 4, 5));
  write_file(folder_ / "2.bin", Bytes().floats(1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(error_of_reading(), HasSubstr("2.bin: 28 bytes are no multiple of 20"));
}

TEST_F(Folder, NamesBinOfWrongLength) {
  write_file(folder_ / "0.bin", Bytes().floats(1, 2, 3, 4));
  write_file(folder_ / "1.bin", Bytes().floats(1, 2, 3, 4).text("abc"));
  EXPECT_THAT(error_of_reading(), HasSubstr("1.bin: 19 bytes are no multiple of 16"));
}

}  // namespace
}  // namespace groundloop
