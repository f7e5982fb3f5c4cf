// Ouster's data packets (software and hardware user manuals): columns of all beams at one encoder
// position, each with a time, the number of the column in the turn, a status, and one record a
// beam, whose form is the profile. Points are in the sensor's frame (lidar_to_sensor_transform), at
// the place that the manual's formula gives: beams start beside the axis.
#include <array>
#include <cmath>
#include <numbers>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/packets/beam_table.hpp"
#include "frontend/recordings/packets/ouster_metadata.hpp"
#include "frontend/recordings/packets/packet_decoder.hpp"

namespace groundloop::recordings {

namespace {

// Where a return is in a beam's record.
struct Return {
  std::size_t range_at;
  bool wide;  // 32 bits, of which `mask` is range; else 16
  std::uint32_t mask;
  unsigned shift;  // to millimetres
  std::size_t reflectivity_at;
  int signal_at;  // -1: none
};
struct Profile {
  const char* name;
  bool legacy;
  std::size_t record;
  std::size_t returns;
  std::array<Return, 2> of;
};
constexpr std::array kProfiles = {
    Profile{"LEGACY", true, 12, 1, {{{0, true, 0xfffff, 0, 4, 6}, {}}}},
    Profile{"RNG19_RFL8_SIG16_NIR16", false, 12, 1, {{{0, true, 0x7ffff, 0, 4, 6}, {}}}},
    Profile{"RNG19_RFL8_SIG16_NIR16_DUAL",
            false,
            16,
            2,
            {{{0, true, 0x7ffff, 0, 3, 8}, {4, true, 0x7ffff, 0, 7, 10}}}},
    Profile{"RNG15_RFL8_NIR8", false, 4, 1, {{{0, false, 0x7fff, 3, 2, -1}, {}}}},
    Profile{"RNG15_RFL8_NIR8_DUAL",
            false,
            8,
            2,
            {{{0, false, 0x7fff, 3, 2, -1}, {4, false, 0x7fff, 3, 6, -1}}}},
};
constexpr std::size_t kPacketHeader = 32, kPacketFooter = 32;  // of the newer profiles

const Profile& profile_of(const OusterMetadata& metadata, const std::string& where) {
  std::string names;
  for (const Profile& profile : kProfiles) {
    if (metadata.profile == profile.name) return profile;
    names += (names.empty() ? "" : ", ") + std::string(profile.name);
  }
  throw InputError(where + ": packets of profile " + metadata.profile.substr(0, 60) +
                   " are not decoded; known are " + names +
                   "; convert them to PointCloud2 with Ouster's ROS driver");
}

class OusterDecoder final : public PacketDecoder {
 public:
  OusterDecoder(OusterMetadata metadata, std::string source, const std::string& where)
      : metadata_(std::move(metadata)), profile_(profile_of(metadata_, where)) {
    column_header_ = profile_.legacy ? 16 : 12;
    column_bytes_ = column_header_ + metadata_.rows * profile_.record + (profile_.legacy ? 4 : 0);
    calibration_ = "Angles of the beams are those of " + source + ".";
    for (const std::string& key : metadata_.assumed)
      calibration_ += " It has no " + key + "; the usual value is taken.";
    BeamTable beams;
    for (std::size_t row = 0; row < metadata_.rows; ++row) {
      cos_.push_back(std::cos(metadata_.elevations[row]));
      sin_.push_back(std::sin(metadata_.elevations[row]));
      beams.push_back({metadata_.elevations[row], 0.0, 0.0, 0.0, 0.0});
    }
    rings_ = rings_of(beams);
  }

  std::string sensor() const override {
    return "Ouster " + (metadata_.product.empty() ? std::string("sensor") : metadata_.product) +
           ", " + std::to_string(metadata_.rows) + " beams, " +
           std::to_string(metadata_.columns_per_frame) + " columns, profile " + profile_.name;
  }
  std::string calibration() const override { return calibration_; }
  AttributeSet attributes() const override {
    return {profile_.of[0].signal_at >= 0, true, true, profile_.returns == 2};
  }
  bool accepts(PacketBytes packet) const override {
    if (packet.size() != packet_bytes()) return false;
    return profile_.legacy || packet_number<std::uint16_t>(packet, 0) == 1;  // kind: lidar
  }
  std::size_t packet_bytes() const {
    return metadata_.columns_per_packet * column_bytes_ +
           (profile_.legacy ? 0 : kPacketHeader + kPacketFooter);
  }
  std::size_t blocks() const override { return metadata_.columns_per_packet; }
  double phase(PacketBytes packet, std::size_t block) const override {
    const auto column = packet_number<std::uint16_t>(packet, column_at(block) + 8);
    return static_cast<double>(column % metadata_.columns_per_frame) /
           static_cast<double>(metadata_.columns_per_frame);
  }
  Nanoseconds clock(PacketBytes packet) const override { return time_of(packet, 0); }
  Nanoseconds clock_period() const override { return 0; }
  Nanoseconds block_time(PacketBytes packet, std::size_t block) const override {
    return time_of(packet, block) - clock(packet);
  }

  void decode(PacketBytes packet, std::size_t first, std::size_t last,
              PacketPoints& out) const override {
    for (std::size_t block = first; block < last; ++block) {
      if (!is_valid(packet, block)) continue;
      const double encoder = -2.0 * std::numbers::pi * phase(packet, block);
      for (std::size_t row = 0; row < metadata_.rows; ++row) {
        const std::size_t at = column_at(block) + column_header_ + row * profile_.record;
        for (std::size_t k = 0; k < profile_.returns; ++k)
          decode_return(packet, at, k, row, encoder, block_time(packet, block), out);
      }
    }
  }

 private:
  std::size_t column_at(std::size_t block) const {
    return (profile_.legacy ? 0 : kPacketHeader) + block * column_bytes_;
  }
  // Clamped: a difference of two must fit.
  Nanoseconds time_of(PacketBytes packet, std::size_t block) const {
    const auto time = packet_number<std::uint64_t>(packet, column_at(block));
    return static_cast<Nanoseconds>(std::min<std::uint64_t>(time, 4'000'000'000'000'000'000U));
  }
  bool is_valid(PacketBytes packet, std::size_t block) const {
    const std::size_t at = column_at(block);
    return profile_.legacy
               ? packet_number<std::uint32_t>(packet, at + column_bytes_ - 4) == 0xffffffffU
               : (packet_number<std::uint16_t>(packet, at + 10) & 1U) != 0;
  }

  static std::uint32_t range_mm(PacketBytes packet, std::size_t at, const Return& form) {
    const std::uint32_t word = form.wide ? packet_number<std::uint32_t>(packet, at + form.range_at)
                                         : packet_number<std::uint16_t>(packet, at + form.range_at);
    return (word & form.mask) << form.shift;
  }

  void decode_return(PacketBytes packet, std::size_t at, std::size_t which, std::size_t row,
                     double encoder, Nanoseconds time, PacketPoints& out) const {
    const Return& form = profile_.of[which];
    const std::uint32_t millimetres = range_mm(packet, at, form);
    const std::uint32_t other =
        profile_.returns == 2 ? range_mm(packet, at, profile_.of[1 - which]) : 0;
    if (millimetres == 0 || (which == 1 && millimetres == other)) return;
    const double offset = metadata_.beam_offset;
    const double along = 1e-3 * millimetres - offset;
    const double angle = encoder - metadata_.azimuths[row];
    const Eigen::Vector3d p(along * std::cos(angle) * cos_[row] + offset * std::cos(encoder),
                            along * std::sin(angle) * cos_[row] + offset * std::sin(encoder),
                            along * sin_[row]);
    out.points.push_back((metadata_.T_sensor_lidar * p).cast<float>());
    out.times.push_back(time);
    if (form.signal_at >= 0)
      out.attributes.intensity.push_back(
          packet_number<std::uint16_t>(packet, at + static_cast<std::size_t>(form.signal_at)));
    out.attributes.reflectivity.push_back(
        std::to_integer<std::uint8_t>(packet[at + form.reflectivity_at]));
    out.attributes.ring.push_back(rings_[row]);
    if (profile_.returns == 2)
      out.attributes.return_number.push_back(other != 0 && other < millimetres ? 2 : 1);
  }

  OusterMetadata metadata_;
  const Profile& profile_;
  std::size_t column_header_ = 0, column_bytes_ = 0;
  std::string calibration_;
  std::vector<double> cos_, sin_;
  std::vector<std::uint16_t> rings_;
};

}  // namespace

std::unique_ptr<PacketDecoder> make_ouster_decoder(const DecoderSource& source) {
  const bool file = !source.calibration_file.empty();
  const std::string text = file ? read_text(source.calibration_file) : source.metadata;
  if (text.empty() || !is_ouster_metadata(text)) return nullptr;
  const std::string where = file ? source.calibration_file : source.where + ": metadata";
  auto decoder = std::make_unique<OusterDecoder>(
      parse_ouster_metadata(text, where), file ? source.calibration_file : "the recorded metadata",
      where);
  if (decoder->accepts(source.packet)) return decoder;
  return nullptr;
}

}  // namespace groundloop::recordings
