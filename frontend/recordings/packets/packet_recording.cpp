#include "frontend/recordings/packets/packet_recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/packets/ouster_metadata.hpp"
#include "frontend/recordings/packets/packet_decoder.hpp"
#include "frontend/recordings/packets/sensor_clock.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

// A step of the head back by less than this share of a turn is a packet that came late.
constexpr double kLateShare = 0.1;
// Without packets for so long, the turn is over.
constexpr Nanoseconds kSilence = 50'000'000;
// No scan is longer, whatever the azimuths say: packets, and nanoseconds.
constexpr std::size_t kMostPackets = 8192;
constexpr Nanoseconds kLongestScan = 1'000'000'000;
// A turn of which less was seen is not whole.
constexpr double kWhole = 0.9;

constexpr std::uint64_t kNowhere = std::numeric_limits<std::uint64_t>::max();

// A block of a packet.
struct BlockPlace {
  PacketPlace packet;
  std::size_t block = 0;
};

// A scan: blocks from `begin` on, up to `end`, which is the next one's.
struct Turn {
  BlockPlace begin, end{{kNowhere, kNowhere}, 0};
  Nanoseconds time = 0;  // from the first packet
  double share = 0.0;    // of a whole turn
};

// The phase at which turns are cut: the middle of the widest sector that is never measured, so that
// a sensor whose field of view is a part of the turn sees it whole; 0 where all is measured.
class CutFinder {
 public:
  void add(const PacketDecoder& decoder, const Packet& packet) {
    for (std::size_t block = 0; block < decoder.blocks(); ++block)
      seen_[static_cast<std::size_t>(decoder.phase(packet.bytes, block) * kBins) % kBins] = true;
  }
  /// Whether as much of the turn was seen as sensors see that are set to a part of it.
  [[nodiscard]] bool saw_a_scan() const {
    return static_cast<std::size_t>(std::count(seen_.begin(), seen_.end(), true)) > 2 * kBins / 5;
  }
  [[nodiscard]] double phase() const {
    std::size_t widest = 0, end = 0, run = 0;
    for (std::size_t i = 0; i < 2 * kBins; ++i) {
      run = seen_[i % kBins] ? 0 : run + 1;
      if (run > widest && run <= kBins) {
        widest = run;
        end = i;
      }
    }
    if (widest < kFewestUnseen) return 0.0;
    return std::fmod((static_cast<double>(end) + 1.0 - 0.5 * static_cast<double>(widest)) / kBins,
                     1.0);
  }

 private:
  static constexpr std::size_t kBins = 360, kFewestUnseen = 15;
  std::array<bool, kBins> seen_{};
};

// Finds the turns in a stream of packets.
class TurnFinder {
 public:
  TurnFinder(const PacketDecoder& decoder, double cut)
      : decoder_(decoder), cut_(cut), clock_(decoder.clock_period()) {}

  void add(const Packet& packet) {
    const Nanoseconds time = clock_.advance(decoder_.clock(packet.bytes), packet.arrival);
    const bool first = turns_.empty();
    const std::size_t turns = turns_.size();
    ++packets_;
    const bool silence = !first && clock_.last_step() > kSilence;
    // A packet may be filled with what is measured after a silence, of which it knows no time: the
    // turn begins with the next one.
    if (silence && packets_ == 1) begin(turns_.back(), packet, 0, time);
    const bool ended = silence && packets_ != 1;
    for (std::size_t block = 0; block < decoder_.blocks(); ++block) {
      const Nanoseconds at = time + decoder_.block_time(packet.bytes, block);
      double phase = decoder_.phase(packet.bytes, block) - cut_;
      if (phase < 0.0) phase += 1.0;
      double step = phase - phase_;
      if (step < 0.0) step += 1.0;
      const bool late = !first && !silence && step > 1.0 - kLateShare;
      if (late) continue;
      if (turns_.empty() || phase < phase_ || (ended && block == 0) || packets_ > kMostPackets ||
          at - turns_.back().time > kLongestScan) {
        if (!turns_.empty()) turns_.back().end = {packet.place, block};
        turns_.emplace_back();
        begin(turns_.back(), packet, block, time);
        packets_ = 0;
      } else {
        turns_.back().share += step;
      }
      phase_ = phase;
    }
    // Between turns a sensor may be silent without having lost anything.
    if (first || silence || turns_.size() > turns) return;
    steps_.push_back(clock_.last_step());
    if (steps_.size() >= kSteps) count_lost();
  }

  void finish() { count_lost(); }
  std::vector<Turn>& turns() { return turns_; }
  const SensorClock& clock() const { return clock_; }
  std::size_t lost() const { return lost_; }

 private:
  static constexpr std::size_t kSteps = 4096;

  void begin(Turn& turn, const Packet& packet, std::size_t block, Nanoseconds time) const {
    turn.begin = {packet.place, block};
    turn.time = time + decoder_.block_time(packet.bytes, block);
  }

  // Packets come evenly; where one is missing the step is twice as long.
  void count_lost() {
    if (steps_.empty()) return;
    std::vector<Nanoseconds> sorted = steps_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const auto usual = static_cast<double>(std::max<Nanoseconds>(*middle, 1));
    for (const Nanoseconds step : steps_) {
      const double times = static_cast<double>(step) / usual;
      if (times > 1.75 && step < kLongestScan) lost_ += static_cast<std::size_t>(times - 0.5);
    }
    steps_.clear();
  }

  const PacketDecoder& decoder_;
  double cut_;
  SensorClock clock_;
  double phase_ = 0.0;
  std::size_t packets_ = 0, lost_ = 0;
  std::vector<Turn> turns_;
  std::vector<Nanoseconds> steps_;
};

// What to do about packets that no decoder knows.
std::string remedy(PacketBytes packet, const PacketSource& source) {
  const auto begins_with = [&](std::initializer_list<unsigned> bytes) {
    return packet.size() > bytes.size() &&
           std::equal(bytes.begin(), bytes.end(), packet.begin(),
                      [](unsigned a, std::byte b) { return std::byte(a) == b; });
  };
  if (begins_with({0x55, 0xaa, 0x05}))
    return "they are Robosense's, which are not decoded; convert them to PointCloud2 with "
           "rslidar_sdk";
  if (!source.metadata.empty()) return "none is of the form that the Ouster metadata tell";
  for (const fs::path& file : source.metadata_candidates) {
    if (make_ouster_decoder({packet, file.string(), {}, {}}) == nullptr) continue;
    return "they are of the form that " + file.filename().string() +
           " tells, an Ouster's metadata: if those are of this sensor, add --calibration " +
           file.string();
  }
  return "known are Velodyne's, Hesai's and Ouster's; the latter need the sensor's metadata: "
         "--calibration FILE.json";
}

class PacketRecording final : public Recording {
 public:
  PacketRecording(PacketSource source, const RecordingOptions& options)
      : source_(std::move(source)), options_(options) {
    info_.path = source_.path;
    info_.format = source_.format;
    info_.notes = std::move(source_.notes);
    info_.warnings = std::move(source_.warnings);
    find_decoder();
    find_turns();
    describe();
  }

  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return turns_.size(); }
  Nanoseconds stamp(std::size_t index) const override { return origin_ + turns_.at(index).time; }

  Scan read(std::size_t index) override {
    Scan scan;
    scan.stamp = stamp(index);
    const BlockPlace& begin = turns_[index].begin;
    const BlockPlace& end = turns_[index].end;
    SensorClock clock(decoder_->clock_period());
    source_.stream->seek(begin.packet);
    Packet packet;
    points_.clear();
    Nanoseconds first_block = 0;
    std::size_t packets = 0;
    while (source_.stream->next(packet)) {
      if (packet.place > end.packet || (packet.place == end.packet && end.block == 0)) break;
      if (!is_ours(packet)) continue;
      const bool first = packets++ == 0;
      if (packets > 2 * kMostPackets) break;
      const Nanoseconds time = clock.advance(decoder_->clock(packet.bytes), packet.arrival);
      const std::size_t from = first ? begin.block : 0;
      const std::size_t to = packet.place == end.packet ? end.block : decoder_->blocks();
      if (first) first_block = decoder_->block_time(packet.bytes, from);
      const std::size_t before = points_.times.size();
      decoder_->decode(packet.bytes, from, to, points_);
      for (std::size_t i = before; i < points_.times.size(); ++i)
        points_.times[i] += time - first_block;
    }
    take_points(scan);
    require_points(scan, points_.points.size(),
                   source_.stream->name() + ", scan at " + seconds_text(scan.stamp) + " s");
    return scan;
  }

 private:
  // A sensor whose packets are in the stream.
  struct Candidate {
    std::uint64_t flow = 0;
    std::string name;  ///< of the flow
    std::unique_ptr<PacketDecoder> decoder;
    std::size_t packets = 0;
  };

  void find_decoder() {
    constexpr std::size_t kTried = 5000, kMostSizes = 64;
    std::map<std::size_t, std::size_t> sizes;
    std::set<std::pair<std::uint64_t, std::size_t>> seen;
    std::vector<Candidate> candidates;
    Packet packet;
    std::vector<std::byte> largest;
    for (std::size_t tried = 0; tried < kTried && source_.stream->next(packet); ++tried) {
      if (seen.size() >= kMostSizes) break;
      ++sizes[packet.bytes.size()];
      const auto known =
          std::find_if(candidates.begin(), candidates.end(),
                       [&](const Candidate& candidate) { return candidate.flow == packet.flow; });
      if (known != candidates.end()) {
        known->packets += known->decoder->accepts(packet.bytes) ? 1 : 0;
        continue;
      }
      if (!seen.emplace(packet.flow, packet.bytes.size()).second) continue;
      if (packet.bytes.size() > largest.size())
        largest.assign(packet.bytes.begin(), packet.bytes.end());
      Candidate found{packet.flow, source_.stream->flow_name(packet.flow), decoder_of(packet), 1};
      if (!found.decoder) continue;
      candidates.push_back(std::move(found));
      if (candidates.front().name.empty()) break;
    }
    if (candidates.empty()) refuse(sizes, largest);
    choose(candidates);
  }

  std::unique_ptr<PacketDecoder> decoder_of(const Packet& packet) const {
    const DecoderSource from{packet.bytes, options_.calibration, source_.metadata,
                             source_.stream->name()};
    for (const auto make : {make_ouster_decoder, make_velodyne_decoder, make_hesai_decoder}) {
      if (auto decoder = make(from)) return decoder;
    }
    return nullptr;
  }

  // Of several sensors recorded together the user chooses one: by sender, port, or both.
  void choose(std::vector<Candidate>& candidates) {
    const std::string& wanted = options_.topic;
    const bool named = !candidates.front().name.empty();
    Candidate* chosen = nullptr;
    std::size_t matching = 0;
    std::string list;
    for (Candidate& candidate : candidates) {
      list +=
          (list.empty() ? "" : ", ") + candidate.name + " (" + candidate.decoder->sensor() + ")";
      const std::size_t colon = candidate.name.find(':');
      const bool meant = wanted.empty() || !named || wanted == candidate.name ||
                         wanted == candidate.name.substr(0, colon) ||
                         (colon != std::string::npos && wanted == candidate.name.substr(colon + 1));
      if (!meant) continue;
      ++matching;
      if (chosen == nullptr) chosen = &candidate;
    }
    if (matching != 1) {
      throw InputError(
          source_.stream->name() +
          (matching == 0 ? ": has no sensor " + wanted + "; choose one with --topic: "
                         : ": holds packets of several sensors; choose one with --topic (sender, "
                           "port or both): ") +
          list);
    }
    if (named && candidates.size() > 1)
      info_.notes.push_back("Packets are those of " + chosen->name + " (of " + list + ").");
    decoder_ = std::move(chosen->decoder);
    flow_ = chosen->flow;
  }

  [[noreturn]] void refuse(const std::map<std::size_t, std::size_t>& sizes,
                           PacketBytes largest) const {
    if (sizes.empty()) {
      throw InputError(source_.stream->name() +
                       ": holds no packet; is it a capture of a LiDAR's UDP traffic?");
    }
    std::string seen;
    for (const auto& [size, count] : sizes)
      seen += (seen.empty() ? "" : ", ") + std::to_string(count) + " of " + std::to_string(size);
    throw InputError(source_.stream->name() + ": its packets (" + seen +
                     " bytes) are of no known sensor: " + remedy(largest, source_));
  }

  bool is_ours(const Packet& packet) const {
    return packet.flow == flow_ && decoder_->accepts(packet.bytes);
  }

  void find_turns() {
    constexpr std::size_t kSurveyed = 4000;
    CutFinder cut;
    Packet packet;
    source_.stream->seek({});
    for (std::size_t i = 0; i < kSurveyed && source_.stream->next(packet); ++i) {
      if (is_ours(packet)) cut.add(*decoder_, packet);
    }
    whole_ = cut.saw_a_scan();
    TurnFinder finder(*decoder_, cut.phase());
    source_.stream->seek({});
    const std::size_t broken_before = source_.stream->broken();
    while (source_.stream->next(packet)) {
      if (is_ours(packet)) {
        finder.add(packet);
        ++ours_;
      } else {
        ++others_;
      }
    }
    finder.finish();
    broken_ = source_.stream->broken() - broken_before;
    turns_ = std::move(finder.turns());
    lost_ = finder.lost();
    origin_ = finder.clock().origin();
    synchronised_ = finder.clock().is_synchronised();
    times_set_ = finder.clock().times_set();
    leave_out_parts();
    put_in_order();
  }

  // Recording begins and ends within a turn.
  void leave_out_parts() {
    if (turns_.size() < 3) return;
    std::vector<double> shares;
    for (const Turn& turn : turns_) shares.push_back(turn.share);
    const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
    std::nth_element(shares.begin(), middle, shares.end());
    const double whole = kWhole * *middle;
    std::size_t left_out = 0;
    if (turns_.back().share < whole) {
      turns_.pop_back();
      ++left_out;
    }
    if (turns_.front().share < whole) {
      turns_.erase(turns_.begin());
      ++left_out;
    }
    if (left_out == 0) return;
    info_.dropped_scans += left_out;
    info_.notes.push_back(left_out == 1
                              ? "One turn at an end of the recording is not whole and left out."
                              : "The first and the last turn are not whole and left out.");
  }

  // Stamps grow; a clock that went back a little makes one scan of two.
  void put_in_order() {
    for (std::size_t i = 1; i < turns_.size();) {
      if (turns_[i].time > turns_[i - 1].time) {
        ++i;
        continue;
      }
      turns_[i - 1].end = turns_[i].end;
      turns_.erase(turns_.begin() + static_cast<std::ptrdiff_t>(i));
      ++info_.out_of_order;
    }
  }

  void describe() {
    info_.sensor = decoder_->sensor();
    info_.attributes = decoder_->attributes();
    info_.fields = {"x", "y", "z"};
    const AttributeSet has = info_.attributes;
    if (has.intensity) info_.fields.emplace_back("intensity");
    if (has.reflectivity) info_.fields.emplace_back("reflectivity");
    if (has.ring) info_.fields.emplace_back("ring");
    if (has.return_number) info_.fields.emplace_back("return_number");
    info_.point_times = "the sensor's clock at each shot, from the first one of each turn";
    info_.stamp_source = synchronised_ ? "the sensor's clock, which agrees with the recorder's"
                                       : "the sensor's clock, set by when packets arrived";
    info_.notes.push_back(decoder_->calibration());
    std::vector<Nanoseconds> stamps;
    for (std::size_t i = 0; i < size(); ++i) stamps.push_back(stamp(i));
    info_.gaps = count_gaps(stamps);
    const auto note = [&](std::size_t count, const std::string& what) {
      if (count > 0) info_.notes.push_back(std::to_string(count) + " " + what);
    };
    note(others_, "packets of other kinds or sensors (position, IMU) are passed over.");
    const auto warn = [&](std::size_t count, const std::string& what) {
      if (count > 0) info_.warnings.push_back(std::to_string(count) + " " + what);
    };
    warn(lost_, "packets are missing beside " + std::to_string(ours_) +
                    " that are there, as gaps in the sensor's clock tell.");
    warn(broken_, "messages or packets are cut off or broken and left out.");
    warn(times_set_, "times the sensor's clock was set; the packets' arrival bridges it.");
    if (size() == 1 && !whole_) {
      info_.warnings.emplace_back(
          "The only turn is not whole: the recording is shorter than one scan.");
    }
  }

  void take_points(Scan& scan) {
    const AttributeSet wanted = options_.attributes & info_.attributes;
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < points_.points.size(); ++i) {
      const Eigen::Vector3f& p = points_.points[i];
      const bool near = std::llabs(points_.times[i]) < 2 * kLongestScan;
      if (is_return(p.x(), p.y(), p.z()) && near) kept.push_back(static_cast<std::uint32_t>(i));
    }
    for (const std::uint32_t i : kept) {
      scan.points.push_back(points_.points[i]);
      scan.times.push_back(static_cast<float>(1e-9 * static_cast<double>(points_.times[i])));
    }
    const auto take = [&](bool want, const auto& from, auto& to) {
      if (!want) return;
      for (const std::uint32_t i : kept) to.push_back(from[i]);
    };
    const PointAttributes& from = points_.attributes;
    PointAttributes& to = scan.attributes;
    take(wanted.intensity, from.intensity, to.intensity);
    take(wanted.reflectivity, from.reflectivity, to.reflectivity);
    take(wanted.ring, from.ring, to.ring);
    take(wanted.return_number, from.return_number, to.return_number);
  }

  PacketSource source_;
  RecordingOptions options_;
  RecordingInfo info_;
  std::unique_ptr<PacketDecoder> decoder_;
  std::vector<Turn> turns_;
  std::uint64_t flow_ = 0;
  Nanoseconds origin_ = 0;
  bool synchronised_ = false;
  std::size_t lost_ = 0, ours_ = 0, others_ = 0, broken_ = 0, times_set_ = 0;
  bool whole_ = true;  // of the turn, where there is one only
  PacketPoints points_;
};

}  // namespace

std::unique_ptr<Recording> make_packet_recording(PacketSource source,
                                                 const RecordingOptions& options) {
  return std::make_unique<PacketRecording>(std::move(source), options);
}

}  // namespace groundloop::recordings
