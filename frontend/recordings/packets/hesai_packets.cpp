// Hesai's data packets (user manuals of Pandar40P, PandarXT-32, PandarQT64): blocks of an azimuth
// in hundredths of a degree and a range and reflectivity for each laser, then a tail with return
// mode, microseconds and date. Where two returns are sent, two blocks share an azimuth.
#include <array>
#include <chrono>
#include <cmath>

#include "frontend/core/error.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/packets/beam_table.hpp"
#include "frontend/recordings/packets/packet_decoder.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::uint16_t kMagic = 0xffee;  // first bytes EE FF
constexpr double kTurn = 36000.0;         // units of azimuth

// Nanoseconds from the packet's clock to the shot of a laser in the n-th group of blocks of one
// azimuth, of `groups` in a packet.
Nanoseconds time_40p(std::size_t group, std::size_t groups, std::size_t laser) {
  constexpr std::array offsets = {42220, 28470, 16040, 3620,  45490, 31740, 47460, 54670,
                                  20620, 33710, 40910, 8190,  20620, 27160, 50730, 8190,
                                  14740, 36980, 45490, 52700, 23890, 31740, 38950, 11470,
                                  18650, 25190, 48760, 6230,  12770, 35010, 21920, 9500,
                                  43520, 29770, 17350, 4920,  42220, 28470, 16040, 3620};
  return -28'580 - 55'560 * static_cast<Nanoseconds>(groups - 1 - group) - offsets[laser];
}
Nanoseconds time_xt32(std::size_t group, std::size_t groups, std::size_t laser) {
  return 5'632 - 50'000 * static_cast<Nanoseconds>(groups - 1 - group) + 368 +
         1'512 * static_cast<Nanoseconds>(laser);
}
Nanoseconds time_qt64(std::size_t group, std::size_t, std::size_t laser) {
  // Four banks of sixteen lasers, 2.057 us from one to the next.
  constexpr std::array banks = {12'310, 46'610, 80'900, 115'200};
  constexpr std::array<Nanoseconds, 16> within = {0,     2060,  4120,  6180,  8230,  10290,
                                                  12350, 14400, 16850, 18910, 20970, 23030,
                                                  25080, 27140, 29190, 31250};
  return 25'710 + 500'000 * static_cast<Nanoseconds>(group) / 3 + banks[laser / 16] +
         within[laser % 16];
}

struct Model {
  const char* name;
  std::size_t bytes;  // without and with a counter behind
  std::size_t bytes_counted;
  std::size_t lasers, blocks;
  std::size_t body, block_bytes;  // where blocks begin, and their size
  std::size_t azimuth_at;         // in a block; units follow
  std::size_t unit_bytes;
  std::size_t mode_at, time_at, date_at;
  int first_year;
  Nanoseconds (*time)(std::size_t group, std::size_t groups, std::size_t laser);
  BeamTable (*nominal)();  // null: there is none
};
const Model kPandar40p = {"Pandar40P", 1262, 1266, 40,   10,   0,        124,    2,
                          3,           1254, 1250, 1256, 2000, time_40p, nullptr};
const Model kPandarXt32 = {"PandarXT-32", 1076, 1080, 32,   8,         12,          130, 0, 4,
                           1062,          1071, 1065, 1900, time_xt32, nominal_xt32};
const Model kPandarQt64 = {"PandarQT64", 1068, 1072, 64,   4,         12,     258, 0, 4,
                           1060,         1056, 1062, 1900, time_qt64, nullptr};

bool has_two_returns(std::uint8_t mode) { return mode >= 0x39 && mode <= 0x3c; }

std::uint8_t byte_at(PacketBytes packet, std::size_t offset) {
  return std::to_integer<std::uint8_t>(packet[offset]);
}

class HesaiDecoder final : public PacketDecoder {
 public:
  HesaiDecoder(const Model& model, const DecoderSource& source)
      : model_(model),
        mode_(byte_at(source.packet, model.mode_at)),
        returns_(has_two_returns(mode_) ? 2 : 1),
        metres_per_unit_(model.body == 0 ? 0.004 : 0.001 * byte_at(source.packet, 9)) {
    if (!source.calibration_file.empty()) {
      beams_ = read_hesai_calibration(source.calibration_file, model.lasers);
      calibration_ = "Angles of the beams are those of " + source.calibration_file + ".";
    } else if (model.nominal != nullptr) {
      beams_ = model.nominal();
      calibration_ =
          "Angles of the beams are those of the model's manual; a calibration of the sensor "
          "itself is given with --calibration.";
    } else {
      throw InputError(source.where + ": packets of a Hesai " + model.name +
                       " need the sensor's correction file; give it with --calibration FILE.csv");
    }
    rings_ = rings_of(beams_);
    for (const Beam& beam : beams_) {
      cos_.push_back(std::cos(beam.elevation));
      sin_.push_back(std::sin(beam.elevation));
    }
  }

  std::string sensor() const override {
    return std::string("Hesai ") + model_.name + ", " + std::to_string(model_.lasers) + " beams, " +
           (returns_ == 2 ? "dual returns" : "one return");
  }
  std::string calibration() const override { return calibration_; }
  AttributeSet attributes() const override { return {false, true, true, returns_ == 2}; }
  bool accepts(PacketBytes packet) const override {
    if (packet.size() != model_.bytes && packet.size() != model_.bytes_counted) return false;
    if (has_two_returns(byte_at(packet, model_.mode_at)) != (returns_ == 2)) return false;
    return model_.body == 0 ? packet_number<std::uint16_t>(packet, 0) == 0xeeff
                            : packet_number<std::uint16_t>(packet, 0) == kMagic &&
                                  byte_at(packet, 6) == model_.lasers;
  }
  std::size_t blocks() const override { return model_.blocks; }
  double phase(PacketBytes packet, std::size_t block) const override {
    return azimuth(packet, block) / kTurn;
  }
  Nanoseconds clock(PacketBytes packet) const override {
    using namespace std::chrono;
    const auto at = [&](std::size_t i) { return byte_at(packet, model_.date_at + i); };
    const year_month_day date{year{model_.first_year + at(0)}, month{at(1)}, day{at(2)}};
    const Nanoseconds us = packet_number<std::uint32_t>(packet, model_.time_at);
    if (!date.ok()) return us * 1'000;  // a clock that was never set
    const auto seconds = sys_days{date}.time_since_epoch() + hours{at(3)} + minutes{at(4)} +
                         std::chrono::seconds{at(5)};
    return duration_cast<nanoseconds>(seconds).count() + us * 1'000;
  }
  Nanoseconds clock_period() const override { return 0; }
  Nanoseconds block_time(PacketBytes, std::size_t block) const override {
    return model_.time(block / returns_, model_.blocks / returns_, 0);
  }

  void decode(PacketBytes packet, std::size_t first, std::size_t last,
              PacketPoints& out) const override {
    for (std::size_t block = first; block < last; ++block) {
      for (std::size_t laser = 0; laser < model_.lasers; ++laser)
        decode_shot(packet, block, laser, out);
    }
  }

 private:
  double azimuth(PacketBytes packet, std::size_t block) const {
    return std::fmod(packet_number<std::uint16_t>(
                         packet, model_.body + block * model_.block_bytes + model_.azimuth_at),
                     kTurn);
  }

  void decode_shot(PacketBytes packet, std::size_t block, std::size_t laser,
                   PacketPoints& out) const {
    const std::size_t at = model_.body + block * model_.block_bytes + model_.azimuth_at + 2 +
                           laser * model_.unit_bytes;
    const auto units = packet_number<std::uint16_t>(packet, at);
    if (units == 0) return;
    std::uint8_t number = 1;
    if (returns_ == 2) {
      const std::size_t other = block % 2 == 0 ? at + model_.block_bytes : at - model_.block_bytes;
      const auto other_units = packet_number<std::uint16_t>(packet, other);
      if (block % 2 == 1 && other_units == units) return;  // one return, sent twice
      number = other_units != 0 && other_units < units ? 2 : 1;
    }
    const double angle =
        azimuth(packet, block) * (kRadiansPerDegree / 100.0) + beams_[laser].azimuth;
    const double range = metres_per_unit_ * units;
    const double flat = range * cos_[laser];
    // Hesai's y is at azimuth 0; azimuths turn clockwise.
    out.points.emplace_back(static_cast<float>(flat * std::sin(angle)),
                            static_cast<float>(flat * std::cos(angle)),
                            static_cast<float>(range * sin_[laser]));
    out.times.push_back(model_.time(block / returns_, model_.blocks / returns_, laser));
    out.attributes.reflectivity.push_back(byte_at(packet, at + 2));
    out.attributes.ring.push_back(rings_[laser]);
    if (returns_ == 2) out.attributes.return_number.push_back(number);
  }

  Model model_;
  std::uint8_t mode_;
  std::size_t returns_;
  double metres_per_unit_;
  std::string calibration_;
  BeamTable beams_;
  std::vector<std::uint16_t> rings_;
  std::vector<double> cos_, sin_;
};

}  // namespace

std::unique_ptr<PacketDecoder> make_hesai_decoder(const DecoderSource& source) {
  const PacketBytes packet = source.packet;
  const auto fits = [&](const Model& model) {
    return packet.size() == model.bytes || packet.size() == model.bytes_counted;
  };
  if (packet.size() < 12) return nullptr;
  if (fits(kPandar40p) && packet_number<std::uint16_t>(packet, 0) == 0xeeff)
    return std::make_unique<HesaiDecoder>(kPandar40p, source);
  if (packet_number<std::uint16_t>(packet, 0) != kMagic) return nullptr;
  for (const Model& model : {kPandarXt32, kPandarQt64}) {
    if (fits(model) && byte_at(packet, 6) == model.lasers && byte_at(packet, 7) == model.blocks)
      return std::make_unique<HesaiDecoder>(model, source);
  }
  throw InputError(source.where + ": packets of a Hesai sensor with " +
                   std::to_string(byte_at(packet, 6)) + " lasers (protocol " +
                   std::to_string(byte_at(packet, 2)) + "." + std::to_string(byte_at(packet, 3)) +
                   ", " + std::to_string(packet.size()) +
                   " bytes) are not decoded; convert them to PointCloud2 with Hesai's ROS driver");
}

}  // namespace groundloop::recordings
