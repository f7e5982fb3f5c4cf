// Packets of a topic: messages of a bag in the order of recording, each a list of packets or one.
#include <algorithm>
#include <limits>

#include "frontend/core/error.hpp"
#include "frontend/recordings/message_reader.hpp"
#include "frontend/recordings/packets/packet_stream.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::size_t kVelodyneBytes = 1206, kPandarBytes = 1500;

struct Item {
  MessageEntry entry;
  std::size_t file = 0;
  Encoding encoding = Encoding::ros1;
};

// A packet within a message.
struct Part {
  std::size_t begin = 0, size = 0;
  Nanoseconds arrival = 0;
};

// The list of packets of a message; empty where it is cut off.
std::vector<Part> parts_of(std::span<const std::byte> message, Encoding encoding,
                           PacketMessage kind, Nanoseconds log_time) {
  MessageReader reader(message, encoding);
  std::vector<Part> parts;
  const auto place_of = [&](std::span<const std::byte> bytes) {
    return static_cast<std::size_t>(bytes.data() - message.data());
  };
  if (kind == PacketMessage::ouster_packet) {
    const auto bytes = reader.blob();
    if (!reader.failed() && !bytes.empty())
      parts.push_back({place_of(bytes), bytes.size(), log_time});
    return parts;
  }
  (void)reader.header();
  const auto count = reader.number<std::uint32_t>();
  const bool velodyne = kind == PacketMessage::velodyne_scan;
  for (std::uint32_t i = 0; i < count && !reader.failed(); ++i) {
    Part part;
    part.arrival = reader.time();
    const auto bytes = reader.bytes(velodyne ? kVelodyneBytes : kPandarBytes);
    part.begin = bytes.empty() ? 0 : place_of(bytes);
    part.size = bytes.size();
    if (!velodyne) part.size = std::min<std::size_t>(part.size, reader.number<std::uint32_t>());
    if (!reader.failed()) parts.push_back(part);
  }
  return parts;
}

class BagPackets final : public PacketStream {
 public:
  BagPackets(std::span<const NamedFile> files, std::string topic, PacketMessage kind)
      : files_(files), topic_(std::move(topic)), kind_(kind) {
    for (std::size_t f = 0; f < files.size(); ++f) {
      const auto& topics = files[f].file->topics();
      const auto it = std::find_if(topics.begin(), topics.end(),
                                   [&](const Topic& t) { return t.name == topic_; });
      if (it == topics.end()) continue;
      for (const MessageEntry& entry : files[f].file->messages(topic_))
        items_.push_back({entry, f, it->encoding});
    }
    std::stable_sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
      return a.entry.log_time < b.entry.log_time;
    });
  }

  bool next(Packet& packet) override {
    while (place_.outer < items_.size()) {
      load();
      if (place_.inner < parts_.size()) {
        const Part& part = parts_[place_.inner];
        packet = {std::span(buffer_).subspan(part.begin, part.size), part.arrival, place_, 0};
        ++place_.inner;
        return true;
      }
      place_ = {place_.outer + 1, 0};
    }
    return false;
  }
  void seek(const PacketPlace& place) override { place_ = place; }
  std::string name() const override {
    return (files_.empty() ? std::string() : files_.front().name + ": ") + "topic " + topic_;
  }

 private:
  void load() {
    if (loaded_ == place_.outer) return;
    const Item& item = items_[place_.outer];
    parts_.clear();
    loaded_ = place_.outer;
    try {
      files_[item.file].file->read(item.entry, std::numeric_limits<std::size_t>::max(), buffer_);
      parts_ = parts_of(buffer_, item.encoding, kind_, item.entry.log_time);
    } catch (const InputError&) {
      ++broken_;
      return;
    }
    if (parts_.empty()) ++broken_;
  }

  std::span<const NamedFile> files_;
  std::string topic_;
  PacketMessage kind_;
  std::vector<Item> items_;
  PacketPlace place_;
  std::uint64_t loaded_ = std::numeric_limits<std::uint64_t>::max();
  std::vector<Part> parts_;
  std::vector<std::byte> buffer_;
};

}  // namespace

PacketMessage packet_message_of(const std::string& type) {
  if (type == "velodyne_msgs/VelodyneScan" || type == "velodyne_msgs/msg/VelodyneScan")
    return PacketMessage::velodyne_scan;
  if (type == "pandar_msgs/PandarScan" || type == "pandar_msgs/msg/PandarScan")
    return PacketMessage::pandar_scan;
  for (const char* package : {"ouster_ros", "ouster_msgs", "ouster_sensor_msgs"}) {
    const std::string name = package;
    if (type == name + "/PacketMsg" || type == name + "/msg/PacketMsg")
      return PacketMessage::ouster_packet;
  }
  return PacketMessage::none;
}

std::unique_ptr<PacketStream> open_bag_packets(std::span<const NamedFile> files,
                                               const std::string& topic, PacketMessage kind) {
  return std::make_unique<BagPackets>(files, topic, kind);
}

}  // namespace groundloop::recordings
