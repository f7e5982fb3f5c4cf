// Raw packets of a sensor in the order of their recording, whatever holds them: a topic of a bag, a
// capture of network traffic.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "frontend/core/scan.hpp"
#include "frontend/recordings/bag_recording.hpp"

namespace groundloop::recordings {

/// Where a packet is; what the two numbers mean is the stream's business. They grow along it.
struct PacketPlace {
  std::uint64_t outer = 0, inner = 0;
  auto operator<=>(const PacketPlace&) const = default;
};

struct Packet {
  std::span<const std::byte> bytes;  ///< valid until the stream moves on
  Nanoseconds arrival = 0;           ///< by the recorder's clock
  PacketPlace place;
  std::uint64_t flow = 0;  ///< whose it is, where several senders are recorded together
};

class PacketStream {
 public:
  virtual ~PacketStream() = default;
  /// The next packet; false at the end. What is cut off or broken is skipped and counted.
  virtual bool next(Packet& packet) = 0;
  /// Goes on with the packet at `place`, which next() has given before; {} is the first one.
  virtual void seek(const PacketPlace& place) = 0;
  /// For messages: file, and topic where there are several.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Whose packets a flow is: "192.168.1.201:2368" (sender and port sent to); empty where the
  /// stream is of one sensor.
  [[nodiscard]] virtual std::string flow_name(std::uint64_t) const { return {}; }
  /// Parts that could not be read since the stream was opened.
  [[nodiscard]] std::size_t broken() const { return broken_; }

 protected:
  std::size_t broken_ = 0;
};

/// How messages hold packets.
enum class PacketMessage {
  none,
  velodyne_scan,  ///< velodyne_msgs/VelodyneScan: packets of 1206 bytes, each with a stamp
  pandar_scan,    ///< pandar_msgs/PandarScan (Hesai): packets of 1500 bytes, length, stamp
  ouster_packet,  ///< PacketMsg of ouster_ros, ouster_msgs and ouster_sensor_msgs: one packet
};
/// By the type's name in either ROS.
[[nodiscard]] PacketMessage packet_message_of(const std::string& type);

/// Packets of a topic. The stream keeps the span: the files must stay where they are.
[[nodiscard]] std::unique_ptr<PacketStream> open_bag_packets(std::span<const NamedFile> files,
                                                             const std::string& topic,
                                                             PacketMessage kind);

/// UDP datagrams of a capture (.pcap; Ethernet with or without VLAN, Linux "cooked", raw IP),
/// fragments put together. Throws InputError where the file is no such capture.
[[nodiscard]] std::unique_ptr<PacketStream> open_pcap_packets(const std::filesystem::path& file);

}  // namespace groundloop::recordings
