// Velodyne's data packets (user manuals of VLP-16, Puck Hi-Res, HDL-32E, VLP-32C, VLS-128): twelve
// blocks of 100 bytes (bank, azimuth in hundredths of a degree, 32 times range and intensity), then
// microseconds of the hour, return mode and model. The lasers of a block fire one after the other
// while the head turns on: each gets the azimuth at its own time.
#include <array>
#include <cmath>

#include "frontend/core/error.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/packets/beam_table.hpp"
#include "frontend/recordings/packets/packet_decoder.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::size_t kBytes = 1206, kBlocks = 12, kBlockBytes = 100, kShots = 32;
constexpr std::size_t kTimeAt = 1200, kModeAt = 1204, kModelAt = 1205;
constexpr std::uint16_t kBank = 0xeeff, kLowerBank = 0xddff;
constexpr std::uint8_t kDual = 0x39;
constexpr double kTurn = 36000.0;  // units of azimuth

struct Model {
  std::uint8_t id;
  const char* name;
  std::size_t beams;
  double metres_per_unit;
  double cycle_us;    // until the same laser fires again, and the azimuth is measured anew
  double shot_us;     // between lasers, or groups of them
  std::size_t group;  // lasers that fire at once
  BeamTable (*nominal)();
};
const std::array kModels = {
    Model{0x22, "VLP-16", 16, 0.002, 110.592, 2.304, 1, nominal_vlp16},
    Model{0x24, "Puck Hi-Res", 16, 0.002, 110.592, 2.304, 1, nominal_puck_hires},
    Model{0x21, "HDL-32E", 32, 0.002, 46.08, 1.152, 1, nominal_hdl32},
    Model{0x28, "VLP-32C", 32, 0.004, 55.296, 2.304, 2, nominal_vlp32c},
    Model{0xa1, "VLS-128", 128, 0.004, 53.3, 2.665, 8, nominal_vls128},
};
constexpr double kVlp16Firing = 55.296;  // us; a block of VLP-16 holds two
constexpr double kVls128Lead = 8.7;      // us; its stamp is later than the first shot by so much

class VelodyneDecoder final : public PacketDecoder {
 public:
  VelodyneDecoder(const Model& model, const DecoderSource& source)
      : model_(model),
        dual_(std::to_integer<std::uint8_t>(source.packet[kModeAt]) == kDual),
        banks_(std::max<std::size_t>(model.beams / kShots, 1)) {
    calibration_ = "Angles of the beams are those of " +
                   (source.calibration_file.empty() ? "the model's manual; a calibration of the "
                                                      "sensor itself is given with --calibration."
                                                    : source.calibration_file + ".");
    beams_ = source.calibration_file.empty()
                 ? model.nominal()
                 : read_velodyne_calibration(source.calibration_file, model.beams);
    rings_ = rings_of(beams_);
    for (const Beam& beam : beams_) {
      cos_.push_back(std::cos(beam.elevation));
      sin_.push_back(std::sin(beam.elevation));
    }
  }

  std::string sensor() const override {
    return std::string("Velodyne ") + model_.name + ", " + std::to_string(model_.beams) +
           " beams, " + (dual_ ? "dual returns" : "one return");
  }
  std::string calibration() const override { return calibration_; }
  AttributeSet attributes() const override { return {true, false, true, dual_}; }
  bool accepts(PacketBytes packet) const override {
    return packet.size() == kBytes &&
           std::to_integer<std::uint8_t>(packet[kModelAt]) == model_.id &&
           (std::to_integer<std::uint8_t>(packet[kModeAt]) == kDual) == dual_ &&
           packet_number<std::uint16_t>(packet, 0) == kBank;
  }
  std::size_t blocks() const override { return kBlocks; }
  double phase(PacketBytes packet, std::size_t block) const override {
    return azimuth(packet, block) / kTurn;
  }
  Nanoseconds clock(PacketBytes packet) const override {
    return Nanoseconds{1'000} * packet_number<std::uint32_t>(packet, kTimeAt);
  }
  Nanoseconds block_time(PacketBytes, std::size_t block) const override {
    return std::llround(1e3 * cycle_us(block));
  }
  Nanoseconds clock_period() const override { return 3'600'000'000'000; }

  void decode(PacketBytes packet, std::size_t first, std::size_t last,
              PacketPoints& out) const override {
    for (std::size_t block = first; block < last; ++block) {
      const std::size_t bank = bank_of(packet, block);
      if (bank >= banks_) continue;
      const double turned = advance(packet, block);
      for (std::size_t shot = 0; shot < kShots; ++shot)
        decode_shot(packet, block, bank, shot, turned, out);
    }
  }

 private:
  static double azimuth(PacketBytes packet, std::size_t block) {
    return std::fmod(packet_number<std::uint16_t>(packet, block * kBlockBytes + 2), kTurn);
  }
  // Which 32 lasers; banks() and more for unknown ones.
  std::size_t bank_of(PacketBytes packet, std::size_t block) const {
    const auto flag = packet_number<std::uint16_t>(packet, block * kBlockBytes);
    return flag > kBank || (kBank - flag) % 0x1100 != 0 ? banks_ : (kBank - flag) / 0x1100U;
  }
  // Blocks that share an azimuth: of all banks and both returns.
  std::size_t together() const { return banks_ * (dual_ ? 2 : 1); }

  // How far the head turns during the cycle that a block belongs to: until the next one; in the
  // last one as in the one before. A packet that holds one cycle only is taken to turn at 10 Hz.
  double advance(PacketBytes packet, std::size_t block) const {
    const std::size_t step = together(), cycle = block / step;
    const std::size_t cycles = kBlocks / step;
    if (cycles < 2) return 10e-6 * model_.cycle_us * kTurn;
    const std::size_t from = std::min(cycle, cycles - 2) * step;
    return std::fmod(azimuth(packet, from + step) - azimuth(packet, from) + kTurn, kTurn);
  }

  // When the cycle of a block begins, from the packet's clock.
  double cycle_us(std::size_t block) const {
    const double lead = model_.beams == 128 ? kVls128Lead : 0.0;
    return static_cast<double>(block / together()) * model_.cycle_us - lead;
  }

  // Microseconds of a shot from the beginning of its cycle.
  double shot_us(std::size_t bank, std::size_t shot) const {
    if (model_.beams == 16)
      return kVlp16Firing * static_cast<double>(shot / 16) +
             model_.shot_us * static_cast<double>(shot % 16);
    const std::size_t group = (bank * kShots + shot) / model_.group;
    // VLS-128 pauses for one shot after its eighth group.
    const std::size_t pause = model_.beams == 128 ? group / 8 : 0;
    return model_.shot_us * static_cast<double>(group + pause);
  }

  void decode_shot(PacketBytes packet, std::size_t block, std::size_t bank, std::size_t shot,
                   double turned, PacketPoints& out) const {
    const std::size_t at = block * kBlockBytes + 4 + shot * 3;
    const auto units = packet_number<std::uint16_t>(packet, at);
    if (units == 0) return;
    std::uint8_t number = 1;
    if (dual_) {
      // Pairs of blocks: the last return, then the strongest, once where they are the same.
      const std::size_t other = (block % 2 == 0 ? at + kBlockBytes : at - kBlockBytes);
      const auto other_units = packet_number<std::uint16_t>(packet, other);
      if (block % 2 == 1 && other_units == units) return;
      number = other_units != 0 && other_units < units ? 2 : 1;
    }
    const std::size_t laser = model_.beams == 16 ? shot % 16 : bank * kShots + shot;
    const Beam& beam = beams_[laser];
    const double within = shot_us(bank, shot);
    const double angle =
        (azimuth(packet, block) + turned * within / model_.cycle_us) * (kRadiansPerDegree / 100.0) +
        beam.azimuth;
    const double range = model_.metres_per_unit * units + beam.range_offset;
    const double flat = range * cos_[laser] - beam.height_offset * sin_[laser];
    const double c = std::cos(angle), s = std::sin(angle);
    // Velodyne's y is ahead and its x to the right; azimuths turn clockwise.
    out.points.emplace_back(
        static_cast<float>(flat * c + beam.side_offset * s),
        static_cast<float>(-flat * s + beam.side_offset * c),
        static_cast<float>(range * sin_[laser] + beam.height_offset * cos_[laser]));
    out.times.push_back(std::llround(1e3 * (cycle_us(block) + within)));
    out.attributes.intensity.push_back(std::to_integer<std::uint8_t>(packet[at + 2]));
    out.attributes.ring.push_back(rings_[laser]);
    if (dual_) out.attributes.return_number.push_back(number);
  }

  Model model_;
  bool dual_;
  std::size_t banks_;
  std::string calibration_;
  BeamTable beams_;
  std::vector<std::uint16_t> rings_;
  std::vector<double> cos_, sin_;
};

}  // namespace

std::unique_ptr<PacketDecoder> make_velodyne_decoder(const DecoderSource& source) {
  const PacketBytes packet = source.packet;
  if (packet.size() != kBytes) return nullptr;
  if (packet_number<std::uint16_t>(packet, 0) != kBank &&
      packet_number<std::uint16_t>(packet, 0) != kLowerBank)
    return nullptr;
  const auto id = std::to_integer<std::uint8_t>(packet[kModelAt]);
  for (const Model& model : kModels) {
    if (model.id == id) return std::make_unique<VelodyneDecoder>(model, source);
  }
  const bool hdl64 = packet_number<std::uint16_t>(packet, kBlockBytes) == kLowerBank;
  throw InputError(source.where + ": packets of a Velodyne " +
                   (hdl64 ? std::string("HDL-64E") : "of model " + std::to_string(id)) +
                   " are not decoded; convert them to PointCloud2 with Velodyne's ROS driver "
                   "(velodyne_pointcloud)");
}

}  // namespace groundloop::recordings
