// Recordings that were interrupted, and paths that hold something else than a recording: what is
// whole is read and what is missing is said; what is no recording is answered with what it is.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bag_bytes.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Interrupted : public ::testing::Test {
 protected:
  std::unique_ptr<Recording> open(const std::string& name) {
    return open_recording((folder_ / name).string());
  }
  std::string error_of(const std::string& name) {
    try {
      (void)open(name);
    } catch (const InputError& e) {
      EXPECT_THAT(std::string(e.what()), ::testing::Not(HasSubstr("\n")));
      return e.what();
    }
    return "none";
  }
  static std::string contents(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // A second apart from 9 s on, and the same two points in each.
  static void expect_first_scans(Recording& recording, std::size_t least, std::size_t most) {
    ASSERT_GE(recording.size(), least);
    ASSERT_LE(recording.size(), most);
    for (std::size_t i = 0; i < recording.size(); ++i) {
      EXPECT_EQ(recording.stamp(i), static_cast<Nanoseconds>(9 + i) * 1'000'000'000);
      EXPECT_EQ(recording.read(i).points.size(), 2U);
    }
  }
  static std::vector<std::string> clouds(std::size_t count) {
    std::vector<std::string> messages;
    for (std::size_t i = 0; i < count; ++i)
      messages.push_back(cdr_cloud(cloud_at(static_cast<std::uint32_t>(9 + i), 0)));
    return messages;
  }
  TemporaryFolder folder_;
};

// Rows are written one after the other, so that a share of the file is a share of the scans.
TEST_F(Interrupted, SqliteBagIsReadUpToWhereItIsCutOff) {
  constexpr std::size_t kScans = 1000;
  make_db3(folder_ / "whole.db3", clouds(kScans));
  EXPECT_THAT(open("whole.db3")->info().warnings, IsEmpty());
  const std::string whole = contents(folder_ / "whole.db3");
  for (const double share : {0.3, 0.6, 0.95}) {
    const auto bytes = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    write_file(folder_ / "cut.db3", whole.substr(0, bytes));
    const auto recording = open("cut.db3");
    EXPECT_THAT(recording->info().warnings, Contains(HasSubstr("cut.db3 is cut off or broken")));
    expect_first_scans(*recording, static_cast<std::size_t>((share - 0.1) * kScans),
                       static_cast<std::size_t>((share + 0.05) * kScans));
  }
  write_file(folder_ / "cut.db3", whole.substr(0, 4096));
  EXPECT_THAT(error_of("cut.db3"), HasSubstr("cut.db3: the database cannot be read"));
}

TEST_F(Interrupted, CompressedSqliteBagIsReadUpToWhereItIsCutOff) {
  make_db3(folder_ / "whole.db3", clouds(1000));
  const std::string packed = compress(contents(folder_ / "whole.db3"), "zstd");
  write_file(folder_ / "b/b_0.db3.zstd", packed.substr(0, packed.size() - 20));
  const auto recording = open("b");
  EXPECT_THAT(recording->info().warnings, Contains("b_0.db3.zstd is cut off."));
  expect_first_scans(*recording, 1, 1000);
}

TEST_F(Interrupted, RosbagUnderTheNameOfItsRecorderIsRead) {
  const std::string bag = make_bag(
      {{10, ros1_cloud(cloud_at(9, 0))}, {11, ros1_cloud(cloud_at(10, 0))}}, "none", false);
  write_file(folder_ / "b/a.bag.active", bag);
  for (const char* name : {"b", "b/a.bag.active"}) {
    const auto recording = open(name);
    EXPECT_EQ(recording->info().format, "rosbag");
    EXPECT_THAT(recording->info().warnings,
                Contains(HasSubstr("a.bag.active was not closed by its recorder")));
    expect_first_scans(*recording, 2, 2);
  }
}

TEST_F(Interrupted, LastScanThatIsCutOffIsLeftOutWhereEnoughIsThere) {
  for (int i = 0; i < 4; ++i)
    write_file(folder_ / ("s/" + std::to_string(i) + ".bin"), Bytes().floats(1, 2, 3, 4));
  write_file(folder_ / "s/times.txt", "0\n0.1\n0.2\n0.3\n");
  write_file(folder_ / "s/3.bin", Bytes().floats(1, 2, 3));
  write_file(folder_ / "s/poses.txt",
             "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 2 0 1 0 0 0 0 1 0\n"
             "1 0 0 3 0 1 0 0 0 0 1 0\n");
  const auto recording = open("s");
  EXPECT_EQ(recording->size(), 3U);
  EXPECT_EQ(recording->info().dropped_scans, 1U);
  EXPECT_THAT(recording->info().warnings,
              Contains(HasSubstr("3.bin: 12 bytes are no multiple of 16")));
  // Ground truth has a line for it.
  ASSERT_EQ(recording->ground_truth().size(), 4U);
  EXPECT_EQ(recording->ground_truth()[2].stamp, recording->stamp(2));
  write_file(folder_ / "s/1.bin", Bytes().floats(1, 2, 3));
  EXPECT_THAT(open("s")->info().warnings, Contains(HasSubstr("1 scan cannot be used: ")));
  EXPECT_THROW((void)open("s")->read(1), InputError);
}

TEST_F(Interrupted, LastPcdThatIsCutOffIsLeftOut) {
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "POINTS 2\nDATA ascii\n1 2 3\n";
  for (int i = 0; i < 4; ++i)
    write_file(folder_ / ("s/" + std::to_string(i) + ".pcd"), pcd + (i < 3 ? "4 5 6\n" : ""));
  const auto recording = open("s");
  EXPECT_EQ(recording->size(), 3U);
  EXPECT_THAT(recording->info().warnings, Contains(HasSubstr("The last scan is left out")));
}

TEST_F(Interrupted, OneScanIsARecordingOfOne) {
  write_file(folder_ / "s/1326030975726043.bin", Bytes().floats(1, 2, 3, 4));
  write_file(folder_ / "s/1326030975826043.bin", Bytes().floats(1, 2, 3, 4));
  const auto recording = open("s/1326030975826043.bin");
  ASSERT_EQ(recording->size(), 1U);
  EXPECT_EQ(recording->info().format, "folder");
  EXPECT_EQ(recording->read(0).points.at(0), Eigen::Vector3f(1, 2, 3));
}

TEST_F(Interrupted, SessionIsToldFromARecording) {
  write_file(folder_ / "s/manifest.json",
             R"({"groundloop": "1", "session_format": 3, "recording": {"path": "drives/a.bag"}})");
  write_file(folder_ / "s/local_maps/000000.pcd", "");
  write_file(folder_ / "s/map.pcd", "");
  for (const char* name : {"s", "s/", "s/local_maps", "s/map.pcd"}) {
    EXPECT_THAT(error_of(name), HasSubstr("a session that groundloop made, and no recording; did "
                                          "you mean its recording, drives/a.bag, or"))
        << name;
  }
}

TEST_F(Interrupted, RecordingsBelowAFolderAreNamed) {
  write_file(folder_ / "data/day1/scans/0.bin", Bytes().floats(1, 2, 3, 4));
  write_file(folder_ / "data/day2/scans/0.bin", Bytes().floats(1, 2, 3, 4));
  fs::create_directories(folder_ / "data/empty");
  const std::string error = error_of("data");
  EXPECT_THAT(error, HasSubstr("data: holds no recording itself, but these folders below do: "));
  EXPECT_THAT(error, HasSubstr("day1/scans, "));
  EXPECT_THAT(error, HasSubstr("day2/scans; name one of them"));
  EXPECT_THAT(error_of("data/empty"), HasSubstr("no recording is recognised here"));
}

TEST_F(Interrupted, FilesOfOtherFormatsAreAnsweredWithWhatConvertsThem) {
  write_file(folder_ / "a.osf", "x");
  write_file(folder_ / "a.pcapng", "x");
  write_file(folder_ / "a.tar.gz", "x");
  EXPECT_THAT(error_of("a.osf"), HasSubstr("`ouster-cli source a.osf save OUT.pcap`"));
  EXPECT_THAT(error_of("a.pcapng"), HasSubstr("`editcap -F pcap a.pcapng OUT.pcap`"));
  EXPECT_THAT(error_of("a.tar.gz"), HasSubstr("unpack it first"));
}

TEST_F(Interrupted, OtherRecordingsInTheFolderAreSaid) {
  write_file(folder_ / "s/a.bag", make_bag({{10, ros1_cloud(cloud_at(9, 0))}}, "none", true));
  write_file(folder_ / "s/0.bin", Bytes().floats(1, 2, 3, 4));
  EXPECT_THAT(open("s")->info().notes,
              Contains(HasSubstr("The folder also holds scans in *.bin, *.pcd or *.ply files, by "
                                 "--format folder")));
}

}  // namespace
}  // namespace groundloop
