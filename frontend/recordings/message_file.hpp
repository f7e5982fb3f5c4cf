// A file of recorded messages, whatever its container: topics, the messages of a topic, their
// bytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "frontend/core/scan.hpp"
#include "frontend/recordings/point_cloud2.hpp"

namespace groundloop::recordings {

struct Topic {
  std::string name;
  std::string type;  ///< e.g. sensor_msgs/PointCloud2 or sensor_msgs/msg/PointCloud2
  Encoding encoding = Encoding::ros1;
  std::size_t messages = 0;
  Nanoseconds first = 0, last = 0;  ///< log times

  /// One scan a message: PointCloud2, Livox CustomMsg.
  [[nodiscard]] bool is_point_cloud() const;
  /// A sensor's raw packets.
  [[nodiscard]] bool is_packets() const;
  /// Messages that are read: scans, packets, and the texts that describe a sensor.
  [[nodiscard]] bool is_read() const;
  void count(Nanoseconds time);  ///< one more message
};

/// Where a message is; what the two places mean is the file's business.
struct MessageEntry {
  Nanoseconds log_time = 0;
  std::uint64_t place = 0, within = 0;
};

/// Enough of a scan's message to hold its header with any frame name in use.
inline constexpr std::size_t kHeadBytes = 1024;

/// Beginnings of messages of compressed chunks, kept from when a file is gone through, so that
/// reading headers does not decompress it once more.
class MessageHeads {
 public:
  void keep(const MessageEntry& entry, std::span<const std::byte> message) {
    const auto head = message.first(std::min(kHeadBytes, message.size()));
    heads_.emplace(std::pair(entry.place, entry.within),
                   std::vector<std::byte>(head.begin(), head.end()));
  }
  /// False where more is asked for than was kept.
  [[nodiscard]] bool find(const MessageEntry& entry, std::size_t limit,
                          std::vector<std::byte>& out) const {
    const auto it = heads_.find({entry.place, entry.within});
    if (it == heads_.end() || limit > kHeadBytes) return false;
    out.assign(it->second.begin(), it->second.begin() + static_cast<std::ptrdiff_t>(
                                                            std::min(limit, it->second.size())));
    return true;
  }
  void clear() { heads_.clear(); }

 private:
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::vector<std::byte>> heads_;
};

class MessageFile {
 public:
  virtual ~MessageFile() = default;
  /// Topics in the file's order.
  [[nodiscard]] const std::vector<Topic>& topics() const { return topics_; }
  /// How the file was read, where that is not the usual way.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// What is wrong with the file but did not stop its reading.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  void add_warning(std::string warning) { warnings_.push_back(std::move(warning)); }
  /// Messages of a topic that is read (Topic::is_read) in the file's order.
  [[nodiscard]] virtual std::vector<MessageEntry> messages(const std::string& topic) = 0;
  /// At least the first `limit` bytes of a message (all where it has fewer) into `out`. Throws
  /// InputError naming the file.
  virtual void read(const MessageEntry& entry, std::size_t limit, std::vector<std::byte>& out) = 0;
  /// Headers have been read: nothing is kept for them any more.
  virtual void forget_heads() {}

 protected:
  std::vector<Topic> topics_;
  std::vector<std::string> notes_, warnings_;
};

/// "a.bag is cut off or broken from byte 100 of 200 on; what stands before is used."
[[nodiscard]] std::string cut_off_warning(const std::filesystem::path& file, std::uint64_t from,
                                          std::uint64_t size);

[[nodiscard]] std::unique_ptr<MessageFile> open_rosbag_file(const std::filesystem::path& file);
[[nodiscard]] std::unique_ptr<MessageFile> open_mcap_file(const std::filesystem::path& file);
[[nodiscard]] std::unique_ptr<MessageFile> open_sqlite_file(const std::filesystem::path& file);

}  // namespace groundloop::recordings
