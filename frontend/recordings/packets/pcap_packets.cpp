// Captures of network traffic as libpcap writes them: a header of 24 bytes, then packets with 16
// bytes of time and length before them. Only UDP over IPv4 is of interest here.
#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include <fcntl.h>
#include <unistd.h>

#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/recordings/byte_cursor.hpp"
#include "frontend/recordings/packets/packet_stream.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kFileHeader = 24, kPacketHeader = 16;
constexpr std::size_t kLargest = 1U << 18U;  // libpcap's own limit
constexpr std::size_t kLargestDatagram = 1U << 16U;
constexpr std::size_t kMostUnfinished = 64;  // datagrams whose fragments are being gathered
constexpr std::uint32_t kEthernet = 1, kRawIp = 101, kRawIpOld = 12, kLinuxCooked = 113;

// Fragments of one datagram.
struct Fragments {
  std::map<std::size_t, std::vector<std::byte>> parts;  // by offset
  std::size_t size = 0;                                 // once the last one is there
  std::uint64_t first = 0;                              // place in the file of the first one seen
};

class PcapPackets final : public PacketStream {
 public:
  explicit PcapPackets(const fs::path& file) : file_(file) {
    fd_ = FileDescriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!fd_) throw InputError(file.string() + ": cannot be opened; check its permissions");
    std::array<std::byte, kFileHeader> header{};
    if (!read_at(0, header)) throw InputError(file.string() + ": is no pcap capture: too short");
    parse(header);
  }

  bool next(Packet& packet) override {
    std::array<std::byte, kPacketHeader> header{};
    while (read_at(at_, header)) {
      ByteCursor fields(header, big_endian_);
      const auto seconds = fields.get<std::uint32_t>();
      const auto fraction = fields.get<std::uint32_t>();
      const auto length = fields.get<std::uint32_t>();
      const std::uint64_t place = at_;
      if (length > kLargest) {
        ++broken_;
        return false;  // nothing says where the next packet is
      }
      frame_.resize(length);
      if (!read_at(at_ + kPacketHeader, frame_)) {
        ++broken_;
        return false;
      }
      at_ += kPacketHeader + length;
      packet.place = {place, 0};
      packet.arrival = static_cast<Nanoseconds>(seconds) * 1'000'000'000 +
                       static_cast<Nanoseconds>(fraction) * (nanoseconds_ ? 1 : 1'000);
      if (datagram(packet)) return true;
    }
    return false;
  }

  void seek(const PacketPlace& place) override {
    at_ = std::max<std::uint64_t>(place.outer, kFileHeader);
    fragments_.clear();
  }
  std::string name() const override { return file_.string(); }
  std::string flow_name(std::uint64_t flow) const override {
    std::string text;
    for (const unsigned shift : {40U, 32U, 24U, 16U})
      text += (text.empty() ? "" : ".") + std::to_string(flow >> shift & 0xffU);
    return text + ":" + std::to_string(flow & 0xffffU);
  }

 private:
  bool read_at(std::uint64_t offset, std::span<std::byte> out) const {
    std::size_t done = 0;
    while (done < out.size()) {
      const ssize_t got = ::pread(fd_.get(), out.data() + done, out.size() - done,
                                  static_cast<off_t>(offset + done));
      if (got <= 0) return false;
      done += static_cast<std::size_t>(got);
    }
    return true;
  }

  void parse(std::span<const std::byte> header) {
    const auto magic = ByteCursor(header).get<std::uint32_t>();
    switch (magic) {
      case 0xa1b2c3d4:
        break;
      case 0xd4c3b2a1:
        big_endian_ = true;
        break;
      case 0xa1b23c4d:
        nanoseconds_ = true;
        break;
      case 0x4d3cb2a1:
        big_endian_ = nanoseconds_ = true;
        break;
      case 0x0a0d0d0a:
        throw InputError(file_.string() +
                         ": is a pcapng capture; convert it with `editcap -F pcap IN OUT.pcap`");
      default:
        throw InputError(file_.string() + ": is no pcap capture: its first bytes are others");
    }
    ByteCursor fields(header.subspan(20), big_endian_);
    link_ = fields.get<std::uint32_t>() & 0x0fffffffU;
    if (link_ != kEthernet && link_ != kRawIp && link_ != kRawIpOld && link_ != kLinuxCooked) {
      throw InputError(file_.string() + ": its link type " + std::to_string(link_) +
                       " is unknown; Ethernet (1), raw IP (101) and Linux cooked (113) are read");
    }
  }

  // The IPv4 packet of frame_; empty where there is none.
  std::span<const std::byte> internet_packet() const {
    const std::span<const std::byte> frame = frame_;
    if (link_ == kRawIp || link_ == kRawIpOld) return frame;
    std::size_t type_at = link_ == kEthernet ? 12 : 14;
    const auto type = [&] {
      return type_at + 2 > frame.size() ? 0U
                                        : std::to_integer<unsigned>(frame[type_at]) << 8U |
                                              std::to_integer<unsigned>(frame[type_at + 1]);
    };
    while (link_ == kEthernet && (type() == 0x8100 || type() == 0x88a8)) type_at += 4;  // VLAN
    return type() == 0x0800 ? frame.subspan(type_at + 2) : std::span<const std::byte>();
  }

  // True where the frame completes a UDP datagram, whose payload then is the packet.
  bool datagram(Packet& packet) {
    const auto ip = internet_packet();
    if (ip.size() < 20 || std::to_integer<unsigned>(ip[0]) >> 4U != 4U) return false;
    const std::size_t header = (std::to_integer<std::size_t>(ip[0]) & 15U) * 4U;
    ByteCursor fields(ip.subspan(2), true);
    const std::size_t total = fields.get<std::uint16_t>();
    const auto id = fields.get<std::uint16_t>();
    const auto flags = fields.get<std::uint16_t>();
    if (header < 20 || total < header || total > ip.size() || ip[9] != std::byte{17}) return false;
    std::span<const std::byte> body = ip.subspan(header, total - header);
    const std::size_t offset = (flags & 0x1fffU) * 8U;
    const bool more = (flags & 0x2000U) != 0;
    if (offset != 0 || more) {
      ByteCursor source(ip.subspan(12), true);
      const std::uint64_t key = std::uint64_t{source.get<std::uint32_t>()} << 16U | id;
      if (!gather(key, offset, more, body, packet.place)) return false;
      body = whole_;
    }
    if (body.size() < 8) return false;
    packet.bytes = body.subspan(8);
    ByteCursor source(ip.subspan(12), true);
    ByteCursor port(body.subspan(2), true);
    packet.flow = std::uint64_t{source.get<std::uint32_t>()} << 16U | port.get<std::uint16_t>();
    return true;
  }

  bool gather(std::uint64_t key, std::size_t offset, bool more, std::span<const std::byte> body,
              PacketPlace& place) {
    if (fragments_.size() >= kMostUnfinished && fragments_.count(key) == 0) {
      broken_ += fragments_.size();
      fragments_.clear();
    }
    const auto [it, fresh] = fragments_.try_emplace(key);
    Fragments& fragments = it->second;
    if (fresh) fragments.first = place.outer;
    if (offset + body.size() > kLargestDatagram) return false;
    fragments.parts[offset].assign(body.begin(), body.end());
    if (!more) fragments.size = offset + body.size();
    std::size_t reached = 0;
    for (const auto& [begin, part] : fragments.parts) {
      if (begin != reached) return false;
      reached += part.size();
    }
    if (fragments.size == 0 || reached != fragments.size) return false;
    whole_.clear();
    for (const auto& [begin, part] : fragments.parts)
      whole_.insert(whole_.end(), part.begin(), part.end());
    place.outer = fragments.first;
    fragments_.erase(it);
    return true;
  }

  fs::path file_;
  FileDescriptor fd_;
  bool big_endian_ = false, nanoseconds_ = false;
  std::uint32_t link_ = kEthernet;
  std::uint64_t at_ = kFileHeader;
  std::vector<std::byte> frame_, whole_;
  std::map<std::uint64_t, Fragments> fragments_;
};

}  // namespace

std::unique_ptr<PacketStream> open_pcap_packets(const fs::path& file) {
  return std::make_unique<PcapPackets>(file);
}

}  // namespace groundloop::recordings
