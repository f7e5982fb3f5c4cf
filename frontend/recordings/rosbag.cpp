// ROS 1 bags (format 2.0). Indexed ones are read by librosbag_storage; where it refuses (no index,
// cut off, broken index, a kind of LZ4 frame it does not know) the records are scanned one by one
// and what is whole is used.
#include <algorithm>
#include <cstring>
#include <map>
#include <optional>

#include <console_bridge/console.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/byte_cursor.hpp"
#include "frontend/recordings/chunk_store.hpp"
#include "frontend/recordings/message_file.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

Nanoseconds to_nanoseconds(std::uint32_t seconds, std::uint32_t nanoseconds) {
  return static_cast<Nanoseconds>(seconds) * 1'000'000'000 + nanoseconds;
}

// ---- through librosbag_storage -----------------------------------------------------------------

// What rosbag::MessageInstance::write needs of a stream.
struct ByteSink {
  std::vector<std::byte>& out;
  std::uint8_t* advance(std::uint32_t size) {
    out.resize(size);
    return reinterpret_cast<std::uint8_t*>(out.data());
  }
};

class LibraryBag final : public MessageFile {
 public:
  // Throws what librosbag_storage throws.
  explicit LibraryBag(const fs::path& file) : file_(file) {
    // What goes wrong comes back as an exception; the library's own lines on stderr say it twice.
    console_bridge::noOutputHandler();
    bag_.open(file.string(), rosbag::bagmode::Read);
    view_ = std::make_unique<rosbag::View>(bag_);
    std::map<std::string, std::size_t> index;
    for (const rosbag::ConnectionInfo* connection : view_->getConnections()) {
      if (!index.emplace(connection->topic, topics_.size()).second) continue;
      topics_.push_back({connection->topic, connection->datatype, Encoding::ros1, 0, 0, 0});
    }
    for (const rosbag::MessageInstance& message : *view_) {
      Topic& topic = topics_.at(index.at(message.getTopic()));
      topic.count(to_nanoseconds(message.getTime().sec, message.getTime().nsec));
      if (topic.is_read()) messages_.push_back(message);
    }
  }

  /// Throws InputError where the library cannot read what its index promises: it knows fewer kinds
  /// of LZ4 frames than there are.
  void check_first_message() {
    std::vector<std::byte> message;
    if (!messages_.empty()) read({0, 0, 0}, 0, message);
  }

  std::vector<MessageEntry> messages(const std::string& topic) override {
    std::vector<MessageEntry> entries;
    for (std::size_t i = 0; i < messages_.size(); ++i) {
      if (messages_[i].getTopic() != topic) continue;
      const ros::Time& time = messages_[i].getTime();
      entries.push_back({to_nanoseconds(time.sec, time.nsec), i, 0});
    }
    return entries;
  }

  void read(const MessageEntry& entry, std::size_t, std::vector<std::byte>& out) override {
    out.clear();
    ByteSink sink{out};
    try {
      messages_.at(entry.place).write(sink);
    } catch (const std::exception& e) {
      throw InputError(file_.string() + ": message " + std::to_string(entry.place) +
                       " cannot be read (" + e.what() + "); the bag is broken there");
    }
  }

 private:
  fs::path file_;
  rosbag::Bag bag_;
  std::unique_ptr<rosbag::View> view_;
  std::vector<rosbag::MessageInstance> messages_;
};

// ---- record by record --------------------------------------------------------------------------

constexpr std::uint32_t kLongestHeader = 1 << 20;
enum Operation : std::uint8_t { kMessage = 0x02, kChunk = 0x05, kConnection = 0x07 };

// The named fields of a record's header.
class RecordHeader {
 public:
  explicit RecordHeader(std::span<const std::byte> bytes) {
    ByteCursor cursor(bytes);
    while (cursor.left() > 0) {
      const std::string_view field = cursor.get_text<std::uint32_t>();
      const std::size_t equals = field.find('=');
      if (cursor.failed() || equals == std::string_view::npos) break;
      fields_.emplace(field.substr(0, equals), field.substr(equals + 1));
    }
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    const auto it = fields_.find(name);
    return it == fields_.end() ? std::string() : it->second;
  }
  template <typename T>
  [[nodiscard]] std::optional<T> number(const std::string& name) const {
    const auto it = fields_.find(name);
    if (it == fields_.end() || it->second.size() != sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, it->second.data(), sizeof(T));
    return value;
  }

 private:
  std::map<std::string, std::string> fields_;
};

class ScannedBag final : public MessageFile {
 public:
  /// `closed`: false where the recorder left no index, as one does that was interrupted.
  ScannedBag(const fs::path& file, const std::string& why, bool closed)
      : file_(file), store_(file) {
    constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
    const std::vector<std::byte> head = store_.read_file(0, kMagic.size());
    if (std::string_view(reinterpret_cast<const char*>(head.data()), head.size()) != kMagic) {
      throw InputError(file.string() +
                       ": does not begin with '#ROSBAG V2.0'; it is no ROS 1 bag "
                       "or of another version (rosbag migrate helps with old ones)");
    }
    notes_.push_back("The index of " + file.filename().string() + " is of no use (" + why +
                     "); its records were scanned.");
    scan_file(kMagic.size());
    if (!closed && warnings_.empty()) {
      warnings_.push_back(file.filename().string() +
                          " was not closed by its recorder: the end may be missing.");
    }
    if (broken_chunks_ > 0) {
      warnings_.push_back(std::to_string(broken_chunks_) + " chunks of " +
                          file.filename().string() + " are broken and left out.");
    }
  }

  std::vector<MessageEntry> messages(const std::string& topic) override {
    std::vector<MessageEntry> entries;
    for (const auto& [connection, entry] : messages_) {
      if (topics_[connections_.at(connection)].name == topic) entries.push_back(entry);
    }
    return entries;
  }

  void forget_heads() override { heads_.clear(); }

  void read(const MessageEntry& entry, std::size_t limit, std::vector<std::byte>& out) override {
    if (heads_.find(entry, limit, out)) return;
    const std::uint64_t offset = entry.within >> 32U, size = entry.within & 0xffffffffU;
    if (!store_.read(entry.place, offset, std::min<std::uint64_t>(size, limit), out)) {
      throw InputError(file_.string() + ": a chunk that was whole cannot be read any more");
    }
  }

 private:
  void scan_file(std::uint64_t position) {
    while (position + 8 <= store_.file_size()) {
      const auto header_size = number_at(position);
      if (header_size > kLongestHeader) return cut_off(position);
      const std::vector<std::byte> header = store_.read_file(position + 4, header_size);
      const std::uint64_t data = position + 8 + header_size;
      if (data > store_.file_size()) return cut_off(position);
      const std::uint64_t data_size = number_at(position + 4 + header_size);
      const bool whole = data_size <= store_.file_size() - data;
      const RecordHeader record(header);
      const auto operation = record.number<std::uint8_t>("op");
      if (!operation) return cut_off(position);
      if (!whole) return cut_off(position);
      if (*operation == kChunk) {
        scan_chunk(record, data, data_size);
      } else if (*operation == kConnection) {
        add_connection(record, store_.read_file(data, data_size));
      }
      position = data + data_size;
    }
    if (position < store_.file_size()) cut_off(position);
  }

  void cut_off(std::uint64_t position) {
    warnings_.push_back(cut_off_warning(file_, position, store_.file_size()));
  }

  std::uint32_t number_at(std::uint64_t position) const {
    const std::vector<std::byte> bytes = store_.read_file(position, 4);
    return ByteCursor(bytes).get<std::uint32_t>();
  }

  void scan_chunk(const RecordHeader& record, std::uint64_t data, std::uint64_t data_size) {
    const auto compression = compression_of(record.text("compression"));
    const auto size = record.number<std::uint32_t>("size");
    std::span<const std::byte> bytes;
    if (!compression || !size) {
      ++broken_chunks_;
      return;
    }
    const std::size_t chunk = store_.add({data, data_size, *size, *compression});
    if (!store_.load(chunk, bytes)) {
      ++broken_chunks_;
      return;
    }
    ByteCursor cursor(bytes);
    while (cursor.left() > 0) {
      const RecordHeader inner(cursor.take_counted<std::uint32_t>());
      const std::span<const std::byte> content = cursor.take_counted<std::uint32_t>();
      if (cursor.failed()) {
        ++broken_chunks_;
        return;
      }
      const auto operation = inner.number<std::uint8_t>("op");
      if (operation == kConnection) add_connection(inner, content);
      if (operation == kMessage) {
        add_message(inner, chunk, cursor.position() - content.size(), content);
      }
    }
  }

  void add_connection(const RecordHeader& record, std::span<const std::byte> content) {
    const auto id = record.number<std::uint32_t>("conn");
    const std::string name = record.text("topic");
    if (!id || connections_.count(*id) != 0) return;
    const std::string type = RecordHeader(content).text("type");
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].name == name) {
        connections_.emplace(*id, i);
        return;
      }
    }
    connections_.emplace(*id, topics_.size());
    topics_.push_back({name, type, Encoding::ros1, 0, 0, 0});
  }

  void add_message(const RecordHeader& record, std::size_t chunk, std::uint64_t offset,
                   std::span<const std::byte> content) {
    const auto id = record.number<std::uint32_t>("conn");
    const auto time = record.number<std::uint64_t>("time");  // seconds, then nanoseconds
    if (!id || !time || connections_.count(*id) == 0) return;
    const Nanoseconds log_time = to_nanoseconds(static_cast<std::uint32_t>(*time & 0xffffffffU),
                                                static_cast<std::uint32_t>(*time >> 32U));
    Topic& topic = topics_[connections_.at(*id)];
    topic.count(log_time);
    if (!topic.is_read()) return;
    const MessageEntry entry{log_time, chunk, offset << 32U | content.size()};
    messages_.emplace_back(*id, entry);
    if (topic.is_point_cloud() && store_.is_compressed(chunk)) heads_.keep(entry, content);
  }

  fs::path file_;
  ChunkStore store_;
  std::map<std::uint32_t, std::size_t> connections_;  // id to topic
  std::vector<std::pair<std::uint32_t, MessageEntry>> messages_;
  MessageHeads heads_;
  std::size_t broken_chunks_ = 0;
};

}  // namespace

std::unique_ptr<MessageFile> open_rosbag_file(const fs::path& file) {
  std::string why;
  bool closed = true;
  try {
    auto bag = std::make_unique<LibraryBag>(file);
    bag->check_first_message();
    return bag;
  } catch (const rosbag::BagUnindexedException& e) {
    why = e.what();
    closed = false;
  } catch (const std::exception& e) {
    why = e.what();
  }
  return std::make_unique<ScannedBag>(file, why, closed);
}

}  // namespace groundloop::recordings
