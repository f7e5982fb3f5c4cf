// MCAP (mcap.dev/spec): with a summary only the chunks that hold point clouds are read, without one
// the whole file. Checksums are held where they are there.
#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "frontend/core/error.hpp"
#include "frontend/recordings/byte_cursor.hpp"
#include "frontend/recordings/chunk_store.hpp"
#include "frontend/recordings/message_file.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::uint64_t kRecordHead = 9;    // opcode and length
constexpr std::uint64_t kMessageHead = 22;  // channel, sequence, log and publish time
constexpr std::uint64_t kFooter = kRecordHead + 20;
constexpr std::uint64_t kChunkHead = 8 + 8 + 8 + 4 + 4 + 64 + 8;  // with room for a name
enum Opcode : std::uint8_t {
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunkRecord = 0x06,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kDataEnd = 0x0f
};

bool is_magic(std::span<const std::byte> bytes) {
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()) == kMagic;
}

// A time that fits, whatever stands in a broken file.
Nanoseconds to_time(std::uint64_t value) {
  return static_cast<Nanoseconds>(std::min<std::uint64_t>(value, kFarthestStamp));
}

class McapFile final : public MessageFile {
 public:
  explicit McapFile(const fs::path& file) : file_(file), store_(file) {
    if (!is_magic(store_.read_file(0, kMagic.size()))) {
      throw InputError(file.string() + ": does not begin as an MCAP file does");
    }
    if (!read_summary()) scan_data();
    if (broken_chunks_ > 0) {
      warnings_.push_back(std::to_string(broken_chunks_) + " chunks of " +
                          file.filename().string() +
                          " are broken (checksum, compression or length) and left out.");
    }
    set_topics();
  }

  std::vector<MessageEntry> messages(const std::string& topic) override {
    std::vector<MessageEntry> entries;
    for (const auto& [channel, entry] : messages_) {
      if (channels_.at(channel).topic.name == topic) entries.push_back(entry);
    }
    return entries;
  }

  void read(const MessageEntry& entry, std::size_t limit, std::vector<std::byte>& out) override {
    if (heads_.find(entry, limit, out)) return;
    const std::uint64_t offset = entry.within >> 32U, size = entry.within & 0xffffffffU;
    if (!store_.read(entry.place, offset, std::min<std::uint64_t>(size, limit), out)) {
      throw InputError(file_.string() + ": a chunk that was whole cannot be read any more");
    }
  }

  void forget_heads() override { heads_.clear(); }

 private:
  struct Channel {
    Topic topic;
    std::uint16_t schema = 0;
  };
  struct Record {
    std::uint8_t opcode = 0;
    std::span<const std::byte> content;
  };

  static std::optional<Record> next_record(ByteCursor& cursor) {
    Record record;
    record.opcode = cursor.get<std::uint8_t>();
    record.content = cursor.take(cursor.get<std::uint64_t>());
    if (cursor.failed()) return std::nullopt;
    return record;
  }

  void add_schema(std::span<const std::byte> content) {
    ByteCursor cursor(content);
    const auto id = cursor.get<std::uint16_t>();
    const std::string name(cursor.get_text<std::uint32_t>());
    if (!cursor.failed() && id != 0) schemas_.emplace(id, name);
  }

  void add_channel(std::span<const std::byte> content) {
    ByteCursor cursor(content);
    Channel channel;
    const auto id = cursor.get<std::uint16_t>();
    channel.schema = cursor.get<std::uint16_t>();
    channel.topic.name = cursor.get_text<std::uint32_t>();
    const std::string_view encoding = cursor.get_text<std::uint32_t>();
    channel.topic.encoding = encoding == "ros1" ? Encoding::ros1 : Encoding::cdr;
    if (cursor.failed()) return;
    const auto schema = schemas_.find(channel.schema);
    if (schema != schemas_.end()) channel.topic.type = schema->second;
    channels_.emplace(id, std::move(channel));
  }

  // Messages of other topics are counted only where a chunk is read anyway.
  void add_message(std::span<const std::byte> content, std::size_t chunk, std::uint64_t offset) {
    ByteCursor cursor(content);
    const auto id = cursor.get<std::uint16_t>();
    (void)cursor.get<std::uint32_t>();  // sequence number
    const Nanoseconds log_time = to_time(cursor.get<std::uint64_t>());
    (void)cursor.get<std::uint64_t>();  // time of publishing
    const auto it = channels_.find(id);
    if (cursor.failed() || it == channels_.end() || offset + content.size() > 0xffffffffU) return;
    it->second.topic.count(log_time);
    if (!it->second.topic.is_read()) return;
    const MessageEntry entry{log_time, chunk,
                             (offset + kMessageHead) << 32U | (content.size() - kMessageHead)};
    messages_.emplace_back(id, entry);
    if (it->second.topic.is_point_cloud() && store_.is_compressed(chunk))
      heads_.keep(entry, content.subspan(kMessageHead));
  }

  // The Chunk record whose content begins at `offset`.
  void add_chunk(std::uint64_t offset, std::uint64_t length) {
    const std::vector<std::byte> head = store_.read_file(offset, std::min(length, kChunkHead));
    ByteCursor cursor(head);
    (void)cursor.get<std::uint64_t>();
    (void)cursor.get<std::uint64_t>();
    const auto size = cursor.get<std::uint64_t>();
    const auto checksum = cursor.get<std::uint32_t>();
    const auto compression = compression_of(cursor.get_text<std::uint32_t>());
    const auto stored = cursor.get<std::uint64_t>();
    std::span<const std::byte> bytes;
    if (cursor.failed() || !compression || stored > length - cursor.position()) {
      ++broken_chunks_;
      return;
    }
    const std::size_t chunk = store_.add({offset + cursor.position(), stored, size, *compression});
    if (!store_.load(chunk, bytes) || (checksum != 0 && crc32(bytes) != checksum)) {
      ++broken_chunks_;
      return;
    }
    ByteCursor records(bytes);
    while (records.left() > 0) {
      const auto record = next_record(records);
      if (!record) {
        ++broken_chunks_;
        return;
      }
      if (record->opcode == kSchema) add_schema(record->content);
      if (record->opcode == kChannel) add_channel(record->content);
      if (record->opcode == kMessage) {
        add_message(record->content, chunk, records.position() - record->content.size());
      }
    }
  }

  // False where there is no summary that can be trusted.
  bool read_summary() {
    const std::uint64_t size = store_.file_size();
    if (size < 2 * kMagic.size() + kFooter) return false;
    const std::uint64_t footer_at = size - kMagic.size() - kFooter;
    const std::vector<std::byte> tail = store_.read_file(footer_at, kFooter + kMagic.size());
    if (tail.size() != kFooter + kMagic.size() || !is_magic(std::span(tail).subspan(kFooter))) {
      return false;
    }
    ByteCursor footer(tail);
    const auto opcode = footer.get<std::uint8_t>();
    const auto length = footer.get<std::uint64_t>();
    const auto start = footer.get<std::uint64_t>();
    (void)footer.get<std::uint64_t>();
    const auto checksum = footer.get<std::uint32_t>();
    if (opcode != 0x02 || length != 20 || start < kMagic.size() || start >= footer_at) return false;
    const std::vector<std::byte> summary = store_.read_file(start, footer_at - start);
    // The checksum covers the summary and the footer up to itself.
    if (checksum != 0 && crc32(std::span(tail).first(kFooter - 4), crc32(summary)) != checksum) {
      warnings_.push_back("The summary of " + file_.filename().string() +
                          " has a wrong checksum; the file is read without it.");
      return false;
    }
    return use_summary(summary);
  }

  struct Place {
    std::uint64_t start = 0, length = 0;
    std::vector<std::uint16_t> channels;  // that have messages there; empty where it is not told
  };

  static std::optional<Place> parse_chunk_index(std::span<const std::byte> record) {
    ByteCursor content(record);
    Place place;
    (void)content.take(16);  // times of the first and last message
    place.start = content.get<std::uint64_t>();
    place.length = content.get<std::uint64_t>();
    ByteCursor map(content.take_counted<std::uint32_t>());
    while (map.left() > 0) {
      place.channels.push_back(map.get<std::uint16_t>());
      (void)map.get<std::uint64_t>();
    }
    if (content.failed() || map.failed()) return std::nullopt;
    return place;
  }

  // Messages by channel.
  static std::map<std::uint16_t, std::uint64_t> parse_statistics(
      std::span<const std::byte> record) {
    ByteCursor content(record);
    (void)content.take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8);
    ByteCursor map(content.take_counted<std::uint32_t>());
    std::map<std::uint16_t, std::uint64_t> counts;
    while (map.left() > 0) {
      const auto id = map.get<std::uint16_t>();
      counts[id] = map.get<std::uint64_t>();
    }
    return counts;
  }

  bool use_summary(std::span<const std::byte> summary) {
    std::vector<Place> places;
    std::map<std::uint16_t, std::uint64_t> counts;
    ByteCursor cursor(summary);
    while (cursor.left() > 0) {
      const auto record = next_record(cursor);
      if (!record) return false;
      if (record->opcode == kSchema) add_schema(record->content);
      if (record->opcode == kChannel) add_channel(record->content);
      if (record->opcode == kStatistics) counts = parse_statistics(record->content);
      if (record->opcode != kChunkIndex) continue;
      auto place = parse_chunk_index(record->content);
      if (!place) return false;
      places.push_back(std::move(*place));
    }
    if (places.empty()) return false;
    for (const Place& place : places) {
      if (!may_hold_clouds(place)) continue;
      if (place.length < kRecordHead || place.start > store_.file_size() ||
          place.length > store_.file_size() - place.start) {
        ++broken_chunks_;
        continue;
      }
      add_chunk(place.start + kRecordHead, place.length - kRecordHead);
    }
    for (auto& [id, channel] : channels_) {
      const auto it = counts.find(id);
      if (it == counts.end() || channel.topic.is_read()) continue;
      channel.topic.messages = it->second;
    }
    return true;
  }

  bool may_hold_clouds(const Place& place) const {
    return place.channels.empty() ||
           std::any_of(place.channels.begin(), place.channels.end(), [&](std::uint16_t id) {
             const auto it = channels_.find(id);
             return it == channels_.end() || it->second.topic.is_read();
           });
  }

  void scan_data() {
    schemas_.clear();
    channels_.clear();
    messages_.clear();
    heads_.clear();
    broken_chunks_ = 0;
    std::uint64_t position = kMagic.size();
    while (position + kRecordHead <= store_.file_size()) {
      const std::vector<std::byte> head = store_.read_file(position, kRecordHead);
      ByteCursor cursor(head);
      const auto opcode = cursor.get<std::uint8_t>();
      const auto length = cursor.get<std::uint64_t>();
      const std::uint64_t content = position + kRecordHead;
      if (opcode == kDataEnd || opcode == 0x02) return;
      if (opcode == 0 || length > store_.file_size() - content) break;
      if (opcode == kSchema) add_schema(store_.read_file(content, length));
      if (opcode == kChannel) add_channel(store_.read_file(content, length));
      if (opcode == kChunkRecord) add_chunk(content, length);
      if (opcode == kMessage && length >= kMessageHead && length <= 0xffffffffU) {
        add_message(store_.read_file(content, length),
                    store_.add({content, length, length, Compression::none}), 0);
      }
      position = content + length;
    }
    warnings_.push_back(cut_off_warning(file_, position, store_.file_size()));
  }

  // One topic may have several channels.
  void set_topics() {
    for (const auto& entry : channels_) {
      const auto& channel = entry.second;
      const auto same = std::find_if(topics_.begin(), topics_.end(), [&](const Topic& topic) {
        return topic.name == channel.topic.name;
      });
      if (same == topics_.end()) {
        topics_.push_back(channel.topic);
      } else {
        same->messages += channel.topic.messages;
      }
    }
  }

  fs::path file_;
  ChunkStore store_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<std::pair<std::uint16_t, MessageEntry>> messages_;
  MessageHeads heads_;
  std::size_t broken_chunks_ = 0;
};

}  // namespace

std::unique_ptr<MessageFile> open_mcap_file(const fs::path& file) {
  return std::make_unique<McapFile>(file);
}

}  // namespace groundloop::recordings
