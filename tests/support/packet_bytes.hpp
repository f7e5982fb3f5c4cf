// Packets of sensors, and what holds them, built byte by byte after the users' manuals.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/bytes.hpp"

namespace groundloop::testing {

/// One return: range in the sensor's units, and intensity.
struct Echo {
  std::uint16_t units = 0;
  std::uint8_t intensity = 0;
};

/// A Velodyne packet of twelve blocks; all shots but those of `echoes` (block, shot) are empty.
struct VelodynePacket {
  std::uint8_t model = 0x22, mode = 0x37;
  std::uint32_t microseconds = 0;
  std::vector<std::uint16_t> azimuths = std::vector<std::uint16_t>(12, 0);
  std::vector<std::uint16_t> banks = std::vector<std::uint16_t>(12, 0xeeff);
  std::map<std::pair<int, int>, Echo> echoes;

  [[nodiscard]] std::string bytes() const {
    Bytes out;
    for (int block = 0; block < 12; ++block) {
      out.put(banks[static_cast<std::size_t>(block)]);
      out.put(azimuths[static_cast<std::size_t>(block)]);
      for (int shot = 0; shot < 32; ++shot) {
        const auto it = echoes.find({block, shot});
        const Echo echo = it == echoes.end() ? Echo{} : it->second;
        out.put(echo.units).put(echo.intensity);
      }
    }
    return out.put(microseconds).put(mode).put(model).str();
  }
};

/// A packet with the seconds and nanoseconds of its arrival.
struct StampedPacket {
  std::uint32_t seconds = 0, nanoseconds = 0;
  std::string bytes;
};

/// velodyne_msgs/VelodyneScan as ROS 1 serialises it.
inline std::string velodyne_scan(const std::vector<StampedPacket>& packets) {
  Bytes out;
  out.put<std::uint32_t>(1).put<std::uint32_t>(5).put<std::uint32_t>(6);
  out.counted<std::uint32_t>("velodyne").put(static_cast<std::uint32_t>(packets.size()));
  for (const StampedPacket& packet : packets)
    out.put(packet.seconds).put(packet.nanoseconds).text(packet.bytes);
  return out.str();
}

/// pandar_msgs/PandarScan as ROS 1 serialises it.
inline std::string pandar_scan(const std::vector<StampedPacket>& packets) {
  Bytes out;
  out.put<std::uint32_t>(1).put<std::uint32_t>(5).put<std::uint32_t>(6);
  out.counted<std::uint32_t>("hesai").put(static_cast<std::uint32_t>(packets.size()));
  for (const StampedPacket& packet : packets) {
    out.put(packet.seconds).put(packet.nanoseconds).text(packet.bytes);
    out.text(std::string(1500 - packet.bytes.size(), '\0'));
    out.put(static_cast<std::uint32_t>(packet.bytes.size()));
  }
  return out.str();
}

/// A frame of Ethernet with a part of a UDP datagram (header included) over IPv4.
inline std::string ethernet_frame(const std::string& part, std::uint16_t id, std::size_t offset,
                                  bool more, bool vlan = false) {
  Bytes out;
  out.text(std::string(12, '\x01'));
  if (vlan) out.put_big<std::uint16_t>(0x8100).put_big<std::uint16_t>(7);
  out.put_big<std::uint16_t>(0x0800);
  out.put<std::uint8_t>(0x45).put<std::uint8_t>(0);
  out.put_big(static_cast<std::uint16_t>(20 + part.size())).put_big(id);
  out.put_big(static_cast<std::uint16_t>((more ? 0x2000U : 0U) | offset / 8));
  out.put<std::uint8_t>(64).put<std::uint8_t>(17).put<std::uint16_t>(0);
  out.put_big<std::uint32_t>(0xc0a80102).put_big<std::uint32_t>(0xc0a80101);
  return out.text(part).str();
}

inline std::string udp(const std::string& payload) {
  return Bytes()
      .put_big<std::uint16_t>(2368)
      .put_big<std::uint16_t>(2368)
      .put_big(static_cast<std::uint16_t>(8 + payload.size()))
      .put<std::uint16_t>(0)
      .text(payload)
      .str();
}

/// A record of a capture; `big` for captures of the other byte order.
inline std::string pcap_record(std::uint32_t seconds, std::uint32_t fraction,
                               const std::string& frame, bool big = false) {
  Bytes out;
  const auto length = static_cast<std::uint32_t>(frame.size());
  if (big) {
    out.put_big(seconds).put_big(fraction).put_big(length).put_big(length);
  } else {
    out.put(seconds).put(fraction).put(length).put(length);
  }
  return out.text(frame).str();
}

inline std::string pcap_header(std::uint32_t magic = 0xa1b2c3d4, std::uint32_t link = 1,
                               bool big = false) {
  Bytes out;
  const auto number = [&](auto value) { big ? out.put_big(value) : out.put(value); };
  number(magic);
  number(std::uint16_t{2});
  number(std::uint16_t{4});
  number(std::uint32_t{0});
  number(std::uint32_t{0});
  number(std::uint32_t{65535});
  number(link);
  return out.str();
}

}  // namespace groundloop::testing
