// What is known of a sensor's packets: when and where its lasers looked, and what came back. One
// decoder a family; the stream of packets, scans and stamps are packet_recording.cpp's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "frontend/core/scan.hpp"

namespace groundloop::recordings {

using PacketBytes = std::span<const std::byte>;

/// Points of blocks of packets.
struct PacketPoints {
  Points points;
  std::vector<Nanoseconds> times;  ///< from clock() of their packet
  PointAttributes attributes;      ///< intensity, ring, return number
  void clear() { *this = {}; }
};

class PacketDecoder {
 public:
  virtual ~PacketDecoder() = default;
  /// E.g. "Velodyne VLP-16, 16 beams, dual returns".
  [[nodiscard]] virtual std::string sensor() const = 0;
  /// Where the angles of the beams come from; a sentence.
  [[nodiscard]] virtual std::string calibration() const = 0;
  /// Attributes that its points have.
  [[nodiscard]] virtual AttributeSet attributes() const = 0;
  /// False for packets of other kinds (position, IMU, other models), which are passed over.
  [[nodiscard]] virtual bool accepts(PacketBytes packet) const = 0;
  /// Groups of points measured at one azimuth.
  [[nodiscard]] virtual std::size_t blocks() const = 0;
  /// Share of the turn at which a block was measured, in [0, 1); a scan is one turn.
  [[nodiscard]] virtual double phase(PacketBytes packet, std::size_t block) const = 0;
  /// The sensor's clock at the beginning of the packet (ns).
  [[nodiscard]] virtual Nanoseconds clock(PacketBytes packet) const = 0;
  /// When a block began, from that clock (ns).
  [[nodiscard]] virtual Nanoseconds block_time(PacketBytes packet, std::size_t block) const = 0;
  /// After which that clock begins anew; 0: never.
  [[nodiscard]] virtual Nanoseconds clock_period() const = 0;
  /// Appends the returns of blocks [first, last).
  virtual void decode(PacketBytes packet, std::size_t first, std::size_t last,
                      PacketPoints& out) const = 0;
};

/// What a decoder is made from: one of its packets, and a calibration where there is one.
struct DecoderSource {
  PacketBytes packet;
  std::string calibration_file;  ///< empty: none
  std::string metadata;          ///< Ouster: JSON text that was recorded with the packets
  std::string where;             ///< begins messages
};
/// Null where the packet is none of the family. Throw InputError where it is one of a model or
/// format that is not decoded, or where the calibration cannot be read or is missing.
[[nodiscard]] std::unique_ptr<PacketDecoder> make_velodyne_decoder(const DecoderSource& source);
[[nodiscard]] std::unique_ptr<PacketDecoder> make_hesai_decoder(const DecoderSource& source);
[[nodiscard]] std::unique_ptr<PacketDecoder> make_ouster_decoder(const DecoderSource& source);

/// A little-endian number of a packet that is known to be long enough.
template <typename T>
[[nodiscard]] T packet_number(PacketBytes packet, std::size_t offset) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
    value =
        static_cast<T>(value | static_cast<T>(std::to_integer<T>(packet[offset + i]) << 8U * i));
  return value;
}

}  // namespace groundloop::recordings
