// Bags built byte by byte from the published formats: ROS bag 2.0, rosbag2's sqlite3, MCAP.
#include <cstdlib>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/compression.hpp"
#include "frontend/recordings/message_file.hpp"
#include "frontend/recordings/point_cloud2.hpp"
#include "frontend/recordings/point_times.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bag_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::HasSubstr;

// ---- PointCloud2
// ---------------------------------------------------------------------------------

void expect_two_points(const Scan& scan) {
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_EQ(scan.points[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(scan.points[1], Eigen::Vector3f(-4.5F, 0.25F, 6));
  ASSERT_EQ(scan.times.size(), 2U);
  EXPECT_NEAR(scan.times[1], 0.09, 1e-8);
}

Scan decode(const std::string& message, recordings::Encoding encoding) {
  const recordings::Cloud cloud = recordings::parse_cloud(bytes_of(message), encoding, "message");
  const auto sample = recordings::sample_times(cloud.table.layout, cloud.data, cloud.table.count,
                                               cloud.header.stamp, "message");
  std::vector<recordings::TimeSample> samples;
  if (sample) samples.push_back(*sample);
  const auto times = recordings::judge_times(samples, {});
  return recordings::decode_points(cloud.table.layout, cloud.data, cloud.table.count,
                                   cloud.header.stamp, {times ? &*times : nullptr, {}, nullptr},
                                   "message");
}

TEST(PointCloud2, DecodesBothEncodingsAndEndians) {
  for (const bool big_points : {false, true}) {
    CloudSpec spec = cloud_at(12, 500);
    spec.big_endian_points = big_points;
    for (const Scan& scan : {decode(ros1_cloud(spec), recordings::Encoding::ros1),
                             decode(cdr_cloud(spec, false), recordings::Encoding::cdr),
                             decode(cdr_cloud(spec, true), recordings::Encoding::cdr)}) {
      EXPECT_EQ(scan.stamp, 12'000'000'500);
      expect_two_points(scan);
    }
  }
}

TEST(PointCloud2, SkipsPaddingBetweenRows) {
  CloudSpec spec;
  spec.height = 2;
  spec.width = 1;
  spec.row_step = 20;
  const std::string points = testing::points_of(spec);
  spec.data = points.substr(0, 16) + "padd" + points.substr(16);
  expect_two_points(decode(ros1_cloud(spec), recordings::Encoding::ros1));
}

// Four thousand million rows, each of no points and padding.
TEST(PointCloud2, RowsOfNoPointsHoldNothing) {
  CloudSpec spec;
  spec.width = 0;
  spec.height = 0xffffffff;
  spec.row_step = 0xffffffff;
  const recordings::Cloud cloud =
      recordings::parse_cloud(bytes_of(ros1_cloud(spec)), recordings::Encoding::ros1, "message");
  EXPECT_EQ(cloud.table.count, 0U);
}

TEST(PointCloud2, NamesWhatIsWrong) {
  const auto expect = [](const std::string& message, const char* text) {
    try {
      (void)decode(message, recordings::Encoding::ros1);
      ADD_FAILURE() << "accepted; expected: " << text;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(text));
    }
  };
  CloudSpec spec;
  const std::string whole = ros1_cloud(spec);
  expect("", "0 bytes are too few");
  for (std::size_t cut = 1; cut + 1 < whole.size(); cut += 7)
    expect(whole.substr(0, cut), "message: ");
  spec.third_field = "w";
  expect(ros1_cloud(spec), "no field 'z'");
  spec = {};
  spec.datatype = 9;
  expect(ros1_cloud(spec), "has datatype 9");
  spec = {};
  spec.width = 0xffffffff;
  spec.height = 0xffffffff;
  spec.point_step = 0xffffffff;
  expect(ros1_cloud(spec), "do not fit its 32 bytes");
  spec.point_step = 0;
  expect(ros1_cloud(spec), "do not fit");
  spec = {};
  spec.point_step = 12;
  expect(ros1_cloud(spec), "field 't' ends at byte 16 of a point of 12 bytes");
}

// ---- ROS 1
// ---------------------------------------------------------------------------------------

class Bags : public ::testing::Test {
 protected:
  std::unique_ptr<Recording> open(const std::string& name, const std::string& topic = "") {
    RecordingOptions options;
    options.topic = topic;
    return open_recording((folder_ / name).string(), options);
  }
  std::string error_of(const std::string& name, const std::string& topic = "") {
    try {
      const auto recording = open(name, topic);
      for (std::size_t i = 0; i < recording->size(); ++i) (void)recording->read(i);
    } catch (const InputError& e) {
      EXPECT_THAT(std::string(e.what()), ::testing::Not(HasSubstr("\n")));
      return e.what();
    }
    return "none";
  }
  static std::string notes(const Recording& recording) {
    std::string text;
    for (const std::string& note : recording.info().notes) text += note + "\n";
    return text;
  }
  static std::string warnings(const Recording& recording) {
    std::string text;
    for (const std::string& warning : recording.info().warnings) text += warning + "\n";
    return text;
  }
  testing::TemporaryFolder folder_;
};

class Rosbag : public Bags, public ::testing::WithParamInterface<std::string> {};

TEST_P(Rosbag, IsReadWithAndWithoutIndexInEveryCompression) {
  for (const bool indexed : {true, false}) {
    write_file(folder_ / "a.bag", make_bag({{10, ros1_cloud(cloud_at(9, 0))},
                                            {11, ros1_cloud(cloud_at(9, 100'000'000))}},
                                           GetParam(), indexed));
    const auto recording = open("a.bag");
    EXPECT_EQ(recording->info().format, "rosbag");
    EXPECT_EQ(recording->info().sensor, "frame os_sensor");
    ASSERT_EQ(recording->size(), 2U);
    EXPECT_EQ(recording->stamp(1), 9'100'000'000);
    expect_two_points(recording->read(1));
    EXPECT_EQ(notes(*recording).find("records were scanned") == std::string::npos, indexed)
        << notes(*recording);
  }
}
INSTANTIATE_TEST_SUITE_P(Compressions, Rosbag, ::testing::Values("none", "lz4", "bz2"));

TEST_F(Bags, CutOffRosbagIsReadAsFarAsItGoes) {
  const std::string bag =
      make_bag({{10, ros1_cloud(cloud_at(9, 0))}, {11, ros1_cloud(cloud_at(10, 0))}}, "none", true);
  // Within the second chunk.
  write_file(folder_ / "a.bag", bag.substr(0, 4096 + 13 + 700));
  const auto recording = open("a.bag");
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_THAT(warnings(*recording), HasSubstr("is cut off or broken from byte"));
  expect_two_points(recording->read(0));
}

TEST_F(Bags, BrokenChunkOfUnindexedRosbagIsLeftOut) {
  std::string bag =
      make_bag({{10, ros1_cloud(cloud_at(9, 0))}, {11, ros1_cloud(cloud_at(10, 0))}}, "bz2", false);
  const std::size_t first = bag.find("BZh");
  bag[first + 30] = static_cast<char>(bag[first + 30] ^ 0x55);  // its checksum is wrong now
  write_file(folder_ / "a.bag", bag);
  const auto recording = open("a.bag");
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_THAT(warnings(*recording), HasSubstr("1 chunks of a.bag are broken"));
}

TEST_F(Bags, SplitRosbagsAreReadInTimeOrder) {
  write_file(folder_ / "b/2.bag", make_bag({{10, ros1_cloud(cloud_at(10, 0))}}, "none", true));
  write_file(folder_ / "b/1.bag", make_bag({{11, ros1_cloud(cloud_at(11, 0))}}, "lz4", true));
  const auto folder = open("b");
  ASSERT_EQ(folder->size(), 2U);
  EXPECT_EQ(folder->stamp(0), 10'000'000'000);
  RecordingOptions options;
  options.more_paths = {(folder_ / "b/2.bag").string()};
  const auto two = open_recording((folder_ / "b/1.bag").string(), options);
  ASSERT_EQ(two->size(), 2U);
  EXPECT_EQ(two->stamp(0), 10'000'000'000);
  expect_two_points(two->read(1));
}

TEST_F(Bags, DisorderDuplicatesGapsAndUselessMessagesAreCounted) {
  CloudSpec empty = cloud_at(15, 0);
  empty.width = 0;
  write_file(folder_ / "a.bag", make_bag({{10, ros1_cloud(cloud_at(10, 0))},
                                          {11, ros1_cloud(cloud_at(12, 0))},
                                          {12, ros1_cloud(cloud_at(11, 0))},  // out of order
                                          {13, ros1_cloud(cloud_at(12, 0))},  // duplicate
                                          {14, ""},                           // zero length
                                          {15, ros1_cloud(empty)},            // no points
                                          {16, ros1_cloud(cloud_at(13, 0))},
                                          {17, ros1_cloud(cloud_at(16, 0))}},  // gap before
                                         "none", true));
  const auto recording = open("a.bag");
  ASSERT_EQ(recording->size(), 5U);
  EXPECT_EQ(recording->stamp(1), 11'000'000'000);
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.out_of_order, 1U);
  EXPECT_EQ(info.duplicates, 1U);
  EXPECT_EQ(info.gaps, 1U);
  EXPECT_EQ(info.dropped_scans, 3U);
  EXPECT_THAT(warnings(*recording), HasSubstr("1 messages are too short"));
}

// A sensor's clock that is set back would mix the stretches before and after.
TEST_F(Bags, AClockThatIsSetBackIsBridged) {
  std::vector<BagMessage> messages;
  for (std::uint32_t i = 0; i < 20; ++i)
    messages.push_back({100 + i, ros1_cloud(cloud_at(i < 10 ? 50 + i : 30 + i, 0))});
  write_file(folder_ / "a.bag", make_bag(messages, "none", true));
  const auto recording = open("a.bag");
  ASSERT_EQ(recording->size(), 20U);
  EXPECT_EQ(recording->info().duplicates, 0U);
  EXPECT_EQ(recording->info().out_of_order, 0U);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(recording->stamp(i), static_cast<Nanoseconds>(50 + i) * 1'000'000'000);
    expect_two_points(recording->read(i));
  }
  EXPECT_THAT(warnings(*recording), HasSubstr("clock was set back 1 time;"));
}

TEST_F(Bags, TimesOfRecordingStandInForConstantHeaders) {
  write_file(
      folder_ / "a.bag",
      make_bag({{10, ros1_cloud(cloud_at(0, 0))}, {11, ros1_cloud(cloud_at(0, 0))}}, "none", true));
  const auto recording = open("a.bag");
  ASSERT_EQ(recording->size(), 2U);
  EXPECT_EQ(recording->info().stamp_source, "times of recording");
  EXPECT_EQ(recording->stamp(1), 11'000'000'000);
}

TEST_F(Bags, NamesWhatIsWrongWithRosbags) {
  write_file(folder_ / "a.bag", "#ROSBAG V1.2\n");
  EXPECT_THAT(error_of("a.bag"), HasSubstr("does not begin with '#ROSBAG V2.0'"));
  write_file(folder_ / "a.bag", "");
  EXPECT_THAT(error_of("a.bag"), HasSubstr("does not begin with"));
  write_file(folder_ / "a.bag", make_bag({{10, "imu"}}, "none", true, "sensor_msgs/Imu"));
  EXPECT_THAT(
      error_of("a.bag"),
      HasSubstr(
          "no topic of type PointCloud2; its topics are /points (sensor_msgs/Imu, 1 messages)"));
  write_file(folder_ / "a.bag", make_bag({{10, "short"}}, "none", true));
  EXPECT_THAT(error_of("a.bag"), HasSubstr("holds no point cloud that can be read"));
  EXPECT_THAT(error_of("a.bag", "/other"), HasSubstr("has no topic /other; choose one of /points"));
}

// ---- MCAP
// ----------------------------------------------------------------------------------------

TEST(Crc32, HasThePublishedCheckValue) {
  EXPECT_EQ(recordings::crc32(bytes_of("123456789")), 0xcbf43926U);
  EXPECT_EQ(recordings::crc32(bytes_of("6789"), recordings::crc32(bytes_of("12345"))), 0xcbf43926U);
}

class Mcap : public Bags, public ::testing::WithParamInterface<std::string> {};

TEST_P(Mcap, IsReadWithAndWithoutSummaryInEveryCompression) {
  for (const bool summary : {true, false}) {
    McapSpec spec;
    spec.compression = GetParam();
    spec.summary = summary;
    write_file(folder_ / "a.mcap", make_mcap(spec));
    const auto recording = open("a.mcap");
    EXPECT_EQ(recording->info().format, "mcap");
    ASSERT_EQ(recording->size(), 2U);
    EXPECT_EQ(recording->stamp(1), 10'000'000'000);
    expect_two_points(recording->read(1));
    EXPECT_EQ(notes(*recording), "");
  }
}
INSTANTIATE_TEST_SUITE_P(Compressions, Mcap, ::testing::Values("none", "lz4", "zstd"));

TEST_F(Bags, McapMessagesOutsideOfChunksAreRead) {
  write_file(folder_ / "a.mcap", kMcapMagic + mcap_record(1, std::string(8, '\0')) +
                                     mcap_schema(1, "sensor_msgs/msg/PointCloud2") +
                                     mcap_channel(1, 1, "/points") +
                                     mcap_message(1, 10, cdr_cloud(cloud_at(9, 0))) +
                                     mcap_record(15, std::string(4, '\0')) +
                                     mcap_record(2, std::string(20, '\0')) + kMcapMagic);
  expect_two_points(open("a.mcap")->read(0));
}

TEST_F(Bags, McapWithWrongChecksumLosesOnlyThatChunk) {
  McapSpec spec;
  spec.crc_error = 1;
  write_file(folder_ / "a.mcap", make_mcap(spec));
  const auto recording = open("a.mcap");
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_THAT(warnings(*recording), HasSubstr("1 chunks of a.mcap are broken (checksum"));
}

TEST_F(Bags, McapWithWrongSummaryIsReadWithoutIt) {
  McapSpec spec;
  spec.summary_crc_error = 1;
  write_file(folder_ / "a.mcap", make_mcap(spec));
  const auto recording = open("a.mcap");
  EXPECT_EQ(recording->size(), 2U);
  EXPECT_THAT(warnings(*recording), HasSubstr("summary of a.mcap has a wrong checksum"));
}

TEST_F(Bags, CutOffMcapIsReadAsFarAsItGoes) {
  McapSpec spec;
  spec.compression = "zstd";
  const std::string file = make_mcap(spec);
  const std::size_t second = file.find("zstd", file.find("zstd") + 4);
  write_file(folder_ / "a.mcap", file.substr(0, second + 30));  // within the second chunk
  const auto recording = open("a.mcap");
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_THAT(warnings(*recording), HasSubstr("a.mcap is cut off or broken from byte"));
}

// Chunks are decompressed once when a file is opened: headers are kept, and come from there even
// where the file is gone meanwhile.
TEST_F(Bags, HeadersOfCompressedChunksAreReadWithoutTheFile) {
  McapSpec spec;
  spec.compression = "zstd";
  write_file(folder_ / "a.mcap", make_mcap(spec));
  write_file(folder_ / "a.bag",
             make_bag({{10, ros1_cloud(cloud_at(9, 0))}, {11, ros1_cloud(cloud_at(10, 0))}}, "lz4",
                      false));
  for (const bool mcap : {true, false}) {
    const fs::path path = folder_ / (mcap ? "a.mcap" : "a.bag");
    const auto file = mcap ? recordings::open_mcap_file(path) : recordings::open_rosbag_file(path);
    const auto entries = file->messages("/points");
    ASSERT_EQ(entries.size(), 2U);
    std::vector<std::byte> whole, head;
    file->read(entries[0], 1U << 20U, whole);
    file->read(entries[1], 1U << 20U, head);  // the chunk in memory is the other one now
    fs::resize_file(path, 0);
    file->read(entries[0], 40, head);
    EXPECT_EQ(head, std::vector<std::byte>(whole.begin(), whole.begin() + 40)) << path;
    file->forget_heads();
    EXPECT_THROW(file->read(entries[0], 40, head), InputError) << path;
  }
}

TEST_F(Bags, SeveralTopicsAreListedAndChosen) {
  McapSpec spec;
  spec.second_topic = true;
  write_file(folder_ / "a.mcap", make_mcap(spec));
  EXPECT_THAT(
      error_of("a.mcap"),
      HasSubstr("choose one with --topic: /more (sensor_msgs/msg/PointCloud2, 2 messages, "));
  EXPECT_EQ(open("a.mcap", "/more")->size(), 2U);
}

TEST_F(Bags, NamesWhatIsNoMcap) {
  write_file(folder_ / "a.mcap", "MCAP");
  EXPECT_THAT(error_of("a.mcap"), HasSubstr("does not begin as an MCAP file does"));
  write_file(folder_ / "a.mcap", kMcapMagic);
  EXPECT_THAT(error_of("a.mcap"), HasSubstr("no topic of type PointCloud2; its topics are none"));
}

// ---- rosbag2
// -------------------------------------------------------------------------------------

TEST_F(Bags, Rosbag2WithSqliteIsReadWithAndWithoutMetadata) {
  make_db3(folder_ / "b/b_0.db3", {cdr_cloud(cloud_at(9, 0)), cdr_cloud(cloud_at(10, 0), true)});
  const auto bare = open("b");
  EXPECT_EQ(bare->info().format, "rosbag2");
  EXPECT_THAT(notes(*bare), HasSubstr("no metadata.yaml"));
  write_file(folder_ / "b/metadata.yaml", metadata("b_0.db3", "", "sqlite3"));
  const auto recording = open("b");
  ASSERT_EQ(recording->size(), 2U);
  EXPECT_EQ(recording->stamp(1), 10'000'000'000);
  expect_two_points(recording->read(0));
  expect_two_points(recording->read(1));
  expect_two_points(open("b/b_0.db3")->read(1));
}

TEST_F(Bags, Rosbag2CompressedByMessageOrFileIsRead) {
  make_db3(folder_ / "m/m_0.db3", {compress(cdr_cloud(cloud_at(9, 0)), "zstd")});
  write_file(folder_ / "m/metadata.yaml", metadata("m_0.db3", "MESSAGE", "sqlite3"));
  expect_two_points(open("m")->read(0));

  make_db3(folder_ / "plain.db3", {cdr_cloud(cloud_at(9, 0))});
  std::ifstream in(folder_ / "plain.db3", std::ios::binary);
  const std::string plain((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  write_file(folder_ / "f/f_0.db3.zstd", compress(plain, "zstd"));
  write_file(folder_ / "f/metadata.yaml", metadata("f_0.db3.zstd", "FILE", "sqlite3"));
  expect_two_points(open("f")->read(0));

  write_file(folder_ / "c/c_0.mcap.zstd", compress(make_mcap({}), "zstd"));
  write_file(folder_ / "c/metadata.yaml", metadata("c_0.mcap.zstd", "FILE", "mcap"));
  const auto mcap = open("c");
  EXPECT_EQ(mcap->info().format, "rosbag2");
  expect_two_points(mcap->read(1));
}

TEST_F(Bags, NamesWhatIsWrongWithRosbag2) {
  write_file(folder_ / "b/metadata.yaml", metadata("gone.db3", "", "sqlite3"));
  EXPECT_THAT(error_of("b"), HasSubstr("gone.db3: is named in metadata.yaml but is not there"));
  write_file(folder_ / "b/gone.db3", "this is no database at all, but long enough to look at");
  EXPECT_THAT(error_of("b"), HasSubstr("gone.db3: the database cannot be read"));
  write_file(folder_ / "b/metadata.yaml", "rosbag2: [\n");
  EXPECT_THAT(error_of("b"), HasSubstr("no YAML that can be read"));
  write_file(folder_ / "b/metadata.yaml", "other: 1\n");
  EXPECT_THAT(error_of("b"), HasSubstr("has no relative_file_paths"));
  write_file(folder_ / "b/z.db3.zstd", "no zstd");
  write_file(folder_ / "b/metadata.yaml", metadata("z.db3.zstd", "FILE", "sqlite3"));
  EXPECT_THAT(error_of("b"), HasSubstr("compressed data are broken"));
}

// A bag that somebody else made does not choose which files of this machine are read.
TEST_F(Bags, Rosbag2NamesFilesOfItsOwnFolderOnly) {
  make_db3(folder_ / "elsewhere.db3", {cdr_cloud(cloud_at(9, 0))});
  for (const std::string& name :
       {std::string("../elsewhere.db3"), (folder_ / "elsewhere.db3").string(),
        std::string("x/../../elsewhere.db3"), std::string("b/../../elsewhere.db3")}) {
    write_file(folder_ / "b/metadata.yaml", metadata(name, "", "sqlite3"));
    EXPECT_THAT(error_of("b"),
                HasSubstr("metadata.yaml: names '" + name + "', which lies outside"));
  }
  // Bags before version 4 put the folder's own name before it.
  make_db3(folder_ / "b/b_0.db3", {cdr_cloud(cloud_at(9, 0))});
  write_file(folder_ / "b/metadata.yaml", metadata("b/b_0.db3", "", "sqlite3"));
  expect_two_points(open("b")->read(0));
}

// Sets TMPDIR for the time of a test.
class TemporaryFiles {
 public:
  explicit TemporaryFiles(const fs::path& folder) {
    if (const char* old = std::getenv("TMPDIR")) old_ = old;
    fs::create_directories(folder);
    ::setenv("TMPDIR", folder.c_str(), 1);
  }
  ~TemporaryFiles() { old_ ? ::setenv("TMPDIR", old_->c_str(), 1) : ::unsetenv("TMPDIR"); }

 private:
  std::optional<std::string> old_;
};

TEST_F(Bags, UnpackedCopiesAreGoneOnceTheyAreOpen) {
  const TemporaryFiles temporary(folder_ / "tmp");
  for (const std::string end : {".db3", ".mcap"}) {
    std::string plain = make_mcap({});
    if (end == ".db3") {
      make_db3(folder_ / "plain.db3", {cdr_cloud(cloud_at(9, 0))});
      std::ifstream in(folder_ / "plain.db3", std::ios::binary);
      plain.assign(std::istreambuf_iterator<char>(in), {});
    }
    write_file(folder_ / "f/f_0.zstd", compress(plain, "zstd"));
    fs::rename(folder_ / "f/f_0.zstd", folder_ / ("f/f_0" + end + ".zstd"));
    const auto recording = open("f");
    EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
    expect_two_points(recording->read(0));
    fs::remove_all(folder_ / "f");
  }
  write_file(folder_ / "f/broken.db3.zstd", "no zstd");
  EXPECT_THAT(error_of("f"), HasSubstr("compressed data are broken"));
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
  fs::remove(folder_ / "tmp");
  EXPECT_THAT(error_of("f"), HasSubstr("TMPDIR names another one"));
}

// 80 MB of zeros in a few kilobytes.
TEST_F(Bags, UnpackingEndsWhereNoRecordingIsSoLarge) {
  const TemporaryFiles temporary(folder_ / "tmp");
  write_file(folder_ / "f/bomb.db3.zstd", compress(std::string(80 << 20, '\0'), "zstd"));
  EXPECT_THAT(error_of("f"), HasSubstr("bomb.db3.zstd: unpacks to more than"));
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
}

}  // namespace
}  // namespace groundloop
