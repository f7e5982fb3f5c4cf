// Bags built byte by byte from the published formats: ROS bag 2.0, MCAP, and ROS 2's sqlite3.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/compression.hpp"
#include "tests/support/bytes.hpp"
#include "tests/support/point_cloud2_bytes.hpp"

namespace groundloop::testing {

inline std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

inline CloudSpec cloud_at(std::uint32_t seconds, std::uint32_t nanoseconds) {
  CloudSpec spec;
  spec.seconds = seconds;
  spec.nanoseconds = nanoseconds;
  return spec;
}

inline std::string field(const std::string& name, const std::string& value) {
  return Bytes().counted<std::uint32_t>(name + "=" + value).str();
}
template <typename T>
std::string field(const std::string& name, T value) {
  return field(name, Bytes().put(value).str());
}
inline std::string record(const std::string& header, const std::string& data) {
  return Bytes().counted<std::uint32_t>(header).counted<std::uint32_t>(data).str();
}
inline std::string time_field(const std::string& name, std::uint32_t seconds) {
  return field(name, Bytes().put(seconds).put<std::uint32_t>(0).str());
}

inline std::string compress(const std::string& data, const std::string& kind) {
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

inline std::string connection_record(std::uint32_t id, const std::string& topic,
                                     const std::string& type) {
  return record(field("op", std::uint8_t{7}) + field("conn", id) + field("topic", topic),
                field("topic", topic) + field("type", type) + field("md5sum", std::string("*")) +
                    field("message_definition", std::string("none")));
}

// One chunk a message, with its index, or without any.
inline std::string make_bag(const std::vector<BagMessage>& messages, const std::string& compression,
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

inline const std::string kMcapMagic("\x89MCAP0\r\n", 8);

inline std::string mcap_record(std::uint8_t opcode, const std::string& content) {
  return Bytes().put(opcode).counted<std::uint64_t>(content).str();
}
inline std::string mcap_schema(std::uint16_t id, const std::string& name) {
  return mcap_record(3, Bytes()
                            .put(id)
                            .counted<std::uint32_t>(name)
                            .counted<std::uint32_t>("ros2msg")
                            .counted<std::uint32_t>("")
                            .str());
}
inline std::string mcap_channel(std::uint16_t id, std::uint16_t schema, const std::string& topic) {
  return mcap_record(4, Bytes()
                            .put(id)
                            .put(schema)
                            .counted<std::uint32_t>(topic)
                            .counted<std::uint32_t>("cdr")
                            .counted<std::uint32_t>("")
                            .str());
}
inline std::string mcap_message(std::uint16_t channel, std::uint64_t time,
                                const std::string& data) {
  return mcap_record(
      5, Bytes().put(channel).put<std::uint32_t>(0).put(time).put(time).text(data).str());
}
inline std::string mcap_chunk(const std::string& records, const std::string& compression,
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

inline std::string make_mcap(const McapSpec& spec) {
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

/// A database of ROS 2 with one message of another topic before those of /points.
inline void make_db3(const std::filesystem::path& file, const std::vector<std::string>& messages,
                     int page_size = 4096) {
  std::filesystem::create_directories(file.parent_path());
  sqlite3* db = nullptr;
  check(sqlite3_open(file.c_str(), &db) == SQLITE_OK, "a database is made");
  const std::string sql =
      "PRAGMA page_size=" + std::to_string(page_size) +
      ";CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
      "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
      "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
      "INSERT INTO topics VALUES(1,'/imu','sensor_msgs/msg/Imu','cdr','');"
      "INSERT INTO topics VALUES(2,'/points','sensor_msgs/msg/PointCloud2','cdr','');"
      "INSERT INTO messages VALUES(1,1,5,x'00');BEGIN;";
  check(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK, "tables are made");
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id,timestamp,data) VALUES(2,?,?)", -1, &insert,
                     nullptr);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    sqlite3_bind_int64(insert, 1, static_cast<sqlite3_int64>(10 + i));
    sqlite3_bind_blob(insert, 2, messages[i].data(), static_cast<int>(messages[i].size()),
                      SQLITE_TRANSIENT);
    check(sqlite3_step(insert) == SQLITE_DONE, "a message is written");
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  check(sqlite3_exec(db, "COMMIT", nullptr, nullptr, nullptr) == SQLITE_OK, "all are kept");
  sqlite3_close(db);
}

inline std::string metadata(const std::string& file, const std::string& mode,
                            const std::string& storage) {
  return "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: " + storage +
         "\n  relative_file_paths:\n    - " + file +
         "\n  compression_format: " + (mode.empty() ? "\"\"" : "zstd") +
         "\n  compression_mode: \"" + mode + "\"\n";
}

}  // namespace groundloop::testing
