// Bags built byte by byte from the published formats: ROS bag 2.0, rosbag2's sqlite3, MCAP.
#include <bzlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/compression.hpp"
#include "frontend/recordings/point_cloud2.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/point_cloud2_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;
using testing::Bytes;
using testing::cdr_cloud;
using testing::CloudSpec;
using ::testing::HasSubstr;
using testing::ros1_cloud;
using testing::write_file;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

CloudSpec cloud_at(std::uint32_t seconds, std::uint32_t nanoseconds) {
  CloudSpec spec;
  spec.seconds = seconds;
  spec.nanoseconds = nanoseconds;
  return spec;
}

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
  const auto times = recordings::infer_time_model(cloud.table.layout, cloud.data, cloud.table.count,
                                                  cloud.header.stamp, 100'000'000);
  return recordings::decode_points(cloud.table.layout, cloud.data, cloud.table.count,
                                   cloud.header.stamp, times, "message");
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

std::string field(const std::string& name, const std::string& value) {
  return Bytes().counted<std::uint32_t>(name + "=" + value).str();
}
template <typename T>
std::string field(const std::string& name, T value) {
  return field(name, Bytes().put(value).str());
}
std::string record(const std::string& header, const std::string& data) {
  return Bytes().counted<std::uint32_t>(header).counted<std::uint32_t>(data).str();
}
std::string time_field(const std::string& name, std::uint32_t seconds) {
  return field(name, Bytes().put(seconds).put<std::uint32_t>(0).str());
}

std::string compress(const std::string& data, const std::string& kind) {
  std::string out(data.size() * 2 + 1000, '\0');
  if (kind == "none") return data;
  if (kind == "bz2") {
    auto size = static_cast<unsigned>(out.size());
    BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(data.data()),
                             static_cast<unsigned>(data.size()), 9, 0, 0);
    out.resize(size);
  } else if (kind == "lz4") {
    LZ4F_preferences_t preferences{};  // as roslz4 writes
    preferences.frameInfo.blockMode = LZ4F_blockIndependent;
    preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
    out.resize(LZ4F_compressFrame(out.data(), out.size(), data.data(), data.size(), &preferences));
  } else {
    out.resize(ZSTD_compress(out.data(), out.size(), data.data(), data.size(), 3));
  }
  return out;
}

struct BagMessage {
  std::uint32_t time;
  std::string data;
};

std::string connection_record(std::uint32_t id, const std::string& topic, const std::string& type) {
  return record(field("op", std::uint8_t{7}) + field("conn", id) + field("topic", topic),
                field("topic", topic) + field("type", type) + field("md5sum", std::string("*")) +
                    field("message_definition", std::string("none")));
}

// One chunk a message, with its index, or without any.
std::string make_bag(const std::vector<BagMessage>& messages, const std::string& compression,
                     bool indexed, const std::string& type = "sensor_msgs/PointCloud2") {
  const std::string connection = connection_record(0, "/points", type);
  std::string chunks, chunk_infos;
  const std::string magic = "#ROSBAG V2.0\n";
  for (const BagMessage& message : messages) {
    const std::string content =
        connection + record(field("op", std::uint8_t{2}) + field("conn", std::uint32_t{0}) +
                                time_field("time", message.time),
                            message.data);
    const auto position = static_cast<std::uint64_t>(magic.size() + 4096 + chunks.size());
    chunks += record(field("op", std::uint8_t{5}) + field("compression", compression) +
                         field("size", static_cast<std::uint32_t>(content.size())),
                     compress(content, compression));
    chunks += record(field("op", std::uint8_t{4}) + field("ver", std::uint32_t{1}) +
                         field("conn", std::uint32_t{0}) + field("count", std::uint32_t{1}),
                     Bytes()
                         .put(message.time)
                         .put<std::uint32_t>(0)
                         .put(static_cast<std::uint32_t>(connection.size()))
                         .str());
    chunk_infos +=
        record(field("op", std::uint8_t{6}) + field("ver", std::uint32_t{1}) +
                   field("chunk_pos", position) + time_field("start_time", message.time) +
                   time_field("end_time", message.time) + field("count", std::uint32_t{1}),
               Bytes().put<std::uint32_t>(0).put<std::uint32_t>(1).str());
  }
  const std::uint64_t index = magic.size() + 4096 + chunks.size();
  const std::string header =
      field("op", std::uint8_t{3}) + field("index_pos", indexed ? index : std::uint64_t{0}) +
      field("conn_count", static_cast<std::uint32_t>(indexed ? 1 : 0)) +
      field("chunk_count", static_cast<std::uint32_t>(indexed ? messages.size() : 0));
  const std::string padding(4096 - 8 - header.size(), ' ');
  return magic + record(header, padding) + chunks +
         (indexed ? connection + chunk_infos : std::string());
}

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
  EXPECT_THAT(notes(*recording), HasSubstr("is cut off or broken from byte"));
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
  EXPECT_THAT(notes(*recording), HasSubstr("1 chunks of a.bag are broken"));
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
  EXPECT_THAT(notes(*recording), HasSubstr("1 messages are too short"));
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

const std::string kMcapMagic("\x89MCAP0\r\n", 8);

std::string mcap_record(std::uint8_t opcode, const std::string& content) {
  return Bytes().put(opcode).counted<std::uint64_t>(content).str();
}
std::string mcap_schema(std::uint16_t id, const std::string& name) {
  return mcap_record(3, Bytes()
                            .put(id)
                            .counted<std::uint32_t>(name)
                            .counted<std::uint32_t>("ros2msg")
                            .counted<std::uint32_t>("")
                            .str());
}
std::string mcap_channel(std::uint16_t id, std::uint16_t schema, const std::string& topic) {
  return mcap_record(4, Bytes()
                            .put(id)
                            .put(schema)
                            .counted<std::uint32_t>(topic)
                            .counted<std::uint32_t>("cdr")
                            .counted<std::uint32_t>("")
                            .str());
}
std::string mcap_message(std::uint16_t channel, std::uint64_t time, const std::string& data) {
  return mcap_record(
      5, Bytes().put(channel).put<std::uint32_t>(0).put(time).put(time).text(data).str());
}
std::string mcap_chunk(const std::string& records, const std::string& compression,
                       std::uint32_t crc_error = 0) {
  return mcap_record(6, Bytes()
                            .put<std::uint64_t>(0)
                            .put<std::uint64_t>(0)
                            .put<std::uint64_t>(records.size())
                            .put<std::uint32_t>(recordings::crc32(bytes_of(records)) ^ crc_error)
                            .counted<std::uint32_t>(compression == "none" ? "" : compression)
                            .counted<std::uint64_t>(compress(records, compression))
                            .str());
}

struct McapSpec {
  std::string compression = "none";
  bool summary = true;
  bool second_topic = false;
  std::uint32_t crc_error = 0, summary_crc_error = 0;
};

std::string make_mcap(const McapSpec& spec) {
  std::string definitions =
      mcap_schema(1, "sensor_msgs/msg/PointCloud2") + mcap_channel(1, 1, "/points");
  if (spec.second_topic) definitions += mcap_channel(2, 1, "/more");
  std::string file =
      kMcapMagic +
      mcap_record(1,
                  Bytes().counted<std::uint32_t>("ros2").counted<std::uint32_t>("by hand").str());
  std::string indices;
  for (std::uint32_t i = 0; i < 2; ++i) {
    const std::string chunk = mcap_chunk(
        definitions + mcap_message(1, 10 + i, cdr_cloud(cloud_at(9 + i, 0))) +
            (spec.second_topic ? mcap_message(2, 10 + i, cdr_cloud(cloud_at(9 + i, 0))) : ""),
        spec.compression, i == 1 ? spec.crc_error : 0);
    Bytes index;
    index.put<std::uint64_t>(0).put<std::uint64_t>(0).put<std::uint64_t>(file.size());
    index.put<std::uint64_t>(chunk.size());
    index.counted<std::uint32_t>(Bytes().put<std::uint16_t>(1).put<std::uint64_t>(0).str());
    index.put<std::uint64_t>(0).counted<std::uint32_t>(spec.compression);
    index.put<std::uint64_t>(0).put<std::uint64_t>(0);
    indices += mcap_record(8, index.str());
    file += chunk;
  }
  file += mcap_record(15, Bytes().put<std::uint32_t>(0).str());
  const std::uint64_t start = spec.summary ? file.size() : 0;
  const std::string summary = spec.summary ? definitions + indices : "";
  Bytes footer;
  footer.put<std::uint8_t>(2).put<std::uint64_t>(20).put(start).put<std::uint64_t>(0);
  const std::uint32_t crc = recordings::crc32(bytes_of(summary + footer.str()));
  return file + summary + footer.str() +
         Bytes().put(spec.summary ? crc ^ spec.summary_crc_error : 0).str() + kMcapMagic;
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
  EXPECT_THAT(notes(*recording), HasSubstr("1 chunks of a.mcap are broken (checksum"));
}

TEST_F(Bags, McapWithWrongSummaryIsReadWithoutIt) {
  McapSpec spec;
  spec.summary_crc_error = 1;
  write_file(folder_ / "a.mcap", make_mcap(spec));
  const auto recording = open("a.mcap");
  EXPECT_EQ(recording->size(), 2U);
  EXPECT_THAT(notes(*recording), HasSubstr("summary of a.mcap has a wrong checksum"));
}

TEST_F(Bags, CutOffMcapIsReadAsFarAsItGoes) {
  McapSpec spec;
  spec.compression = "zstd";
  const std::string file = make_mcap(spec);
  const std::size_t second = file.find("zstd", file.find("zstd") + 4);
  write_file(folder_ / "a.mcap", file.substr(0, second + 30));  // within the second chunk
  const auto recording = open("a.mcap");
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_THAT(notes(*recording), HasSubstr("a.mcap is cut off or broken from byte"));
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

void make_db3(const fs::path& file, const std::vector<std::string>& messages) {
  fs::create_directories(file.parent_path());
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(
                db,
                "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
                "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
                "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
                "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
                "INSERT INTO topics VALUES(1,'/imu','sensor_msgs/msg/Imu','cdr','');"
                "INSERT INTO topics VALUES(2,'/points','sensor_msgs/msg/PointCloud2','cdr','');"
                "INSERT INTO messages VALUES(1,1,5,x'00');",
                nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id,timestamp,data) VALUES(2,?,?)", -1, &insert,
                     nullptr);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    sqlite3_bind_int64(insert, 1, static_cast<sqlite3_int64>(10 + i));
    sqlite3_bind_blob(insert, 2, messages[i].data(), static_cast<int>(messages[i].size()),
                      SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  sqlite3_close(db);
}

std::string metadata(const std::string& file, const std::string& mode, const std::string& storage) {
  return "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: " + storage +
         "\n  relative_file_paths:\n    - " + file +
         "\n  compression_format: " + (mode.empty() ? "\"\"" : "zstd") +
         "\n  compression_mode: \"" + mode + "\"\n";
}

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

}  // namespace
}  // namespace groundloop
