// A ROS 2 bag with sqlite3 storage: DIR/metadata.yaml and DIR/recording_0.db3.
#include <sqlite3.h>

#include "frontend/core/error.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/layouts/point_cloud2_writer.hpp"

namespace groundloop::layouts {
namespace fs = std::filesystem;

namespace {

class Rosbag2Writer final : public Writer {
 public:
  Rosbag2Writer(const fs::path& folder, const Source& source)
      : folder_(folder), stamps_(source.stamps) {
    if (!source.ground_truth.empty()) write_tum(folder / "ground_truth.tum", source.ground_truth);
    sqlite3* database = nullptr;
    const int result = sqlite3_open((folder / "recording_0.db3").c_str(), &database);
    database_.reset(database);
    if (result != SQLITE_OK) fail();
    run("PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; BEGIN;"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
        "INSERT INTO topics VALUES(1, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr', '');");
    sqlite3_stmt* insert = nullptr;
    if (sqlite3_prepare_v2(database,
                           "INSERT INTO messages(topic_id, timestamp, data) VALUES(1,?,?)", -1,
                           &insert, nullptr) != SQLITE_OK) {
      fail();
    }
    insert_.reset(insert);
  }

  void write(std::size_t, const Scan& scan) override {
    const ByteWriter message = cdr_message(scan, TimeField::timestamp_s);
    sqlite3_bind_int64(insert_.get(), 1, scan.stamp);
    sqlite3_bind_blob64(insert_.get(), 2, message.bytes().data(), message.size(), SQLITE_STATIC);
    if (sqlite3_step(insert_.get()) != SQLITE_DONE) fail();
    sqlite3_reset(insert_.get());
  }

  void finish() override {
    insert_.reset();
    run("COMMIT;");
    database_.reset();
    const std::string count = std::to_string(stamps_.size());
    const std::string start = std::to_string(stamps_.front());
    const std::string duration = std::to_string(stamps_.back() - stamps_.front());
    write_bytes(folder_ / "metadata.yaml",
                "rosbag2_bagfile_information:\n"
                "  version: 5\n"
                "  storage_identifier: sqlite3\n"
                "  duration:\n    nanoseconds: " +
                    duration +
                    "\n"
                    "  starting_time:\n    nanoseconds_since_epoch: " +
                    start +
                    "\n"
                    "  message_count: " +
                    count +
                    "\n"
                    "  topics_with_message_count:\n"
                    "    - topic_metadata:\n"
                    "        name: /points\n"
                    "        type: sensor_msgs/msg/PointCloud2\n"
                    "        serialization_format: cdr\n"
                    "        offered_qos_profiles: \"\"\n"
                    "      message_count: " +
                    count +
                    "\n"
                    "  compression_format: \"\"\n"
                    "  compression_mode: \"\"\n"
                    "  relative_file_paths:\n    - recording_0.db3\n"
                    "  files:\n"
                    "    - path: recording_0.db3\n"
                    "      starting_time:\n        nanoseconds_since_epoch: " +
                    start +
                    "\n"
                    "      duration:\n        nanoseconds: " +
                    duration +
                    "\n"
                    "      message_count: " +
                    count + "\n");
  }

 private:
  void run(const char* sql) {
    if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  [[noreturn]] void fail() const {
    throw InputError((folder_ / "recording_0.db3").string() + ": cannot be written (" +
                     sqlite3_errmsg(database_.get()) + ")");
  }
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  fs::path folder_;
  std::vector<Nanoseconds> stamps_;
  std::unique_ptr<sqlite3, Close> database_;
  std::unique_ptr<sqlite3_stmt, Close> insert_;
};

}  // namespace

std::unique_ptr<Writer> make_rosbag2_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<Rosbag2Writer>(folder, source);
}

}  // namespace groundloop::layouts
