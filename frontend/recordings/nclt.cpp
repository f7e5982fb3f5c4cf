// NCLT (Carlevaris-Bianco et al., IJRR 2016): a Segway with an HDL-32E that hangs upside down.
// velodyne_sync holds one deskewed scan a file, velodyne_hits.bin all packets of a session.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/datasets.hpp"
#include "frontend/recordings/ground_truth.hpp"
#include "frontend/recordings/scan_files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr const char* kFields = "uint16 x y z, uint8 intensity, laser";
constexpr std::size_t kHit = 8;             // u16 x y z, u8 intensity, u8 laser
constexpr std::size_t kPacketHeader = 24;   // u16 magic x4, u32 hits, u64 utime, u32 padding
constexpr double kAzimuthError = 0.003;     // rad
constexpr std::size_t kMostHits = 100'000;  // a packet has at most 384

// A hit in the frame with z upward; false for what is no return.
bool decode_hit(const std::byte* at, Eigen::Vector3f& p) {
  std::uint16_t raw[3];
  std::memcpy(raw, at, sizeof raw);
  const auto metres = [](std::uint16_t value) {
    return static_cast<float>(kNcltScale * value + kNcltOffset);
  };
  p = Eigen::Vector3f(metres(raw[0]), -metres(raw[1]), -metres(raw[2]));
  return is_return(p.x(), p.y(), p.z());
}

// A hit with the attributes asked for; false where it is no return.
bool append_hit(const std::byte* at, const AttributeSet& attributes, Scan& scan) {
  Eigen::Vector3f p;
  if (!decode_hit(at, p)) return false;
  scan.points.push_back(p);
  if (attributes.intensity)
    scan.attributes.intensity.push_back(std::to_integer<std::uint8_t>(at[6]));
  if (attributes.ring) scan.attributes.ring.push_back(std::to_integer<std::uint8_t>(at[7]));
  return true;
}

void describe_hits(RecordingInfo& info) {
  info.fields = {"x uint16", "y uint16", "z uint16", "intensity uint8", "laser uint8"};
  info.attributes.intensity = info.attributes.ring = true;
}

Trajectory read_truth(const fs::path& path, bool of_velodyne, RecordingInfo& info) {
  const fs::path absolute = fs::absolute(path).lexically_normal();
  const fs::path self = absolute.has_filename() ? absolute : absolute.parent_path();
  const std::string name = "groundtruth_" + self.filename().string() + ".csv";
  std::error_code error;
  std::vector<fs::path> candidates = {self.parent_path() / name,
                                      self.parent_path() / "ground_truth" / name};
  for (const fs::path& file : list_files(self, ".csv")) {
    if (file.filename().string().rfind("groundtruth", 0) == 0) {
      candidates.insert(candidates.begin(), file);
    }
  }
  for (const fs::path& file : candidates) {
    if (!fs::exists(file, error)) continue;
    const NumberTable table = read_numbers(file, true);
    if (table.columns != 7) {
      throw InputError(file.string() + ": " + std::to_string(table.columns) +
                       " columns; expected 7 (utime x y z roll pitch heading)");
    }
    Trajectory truth;
    const Pose T_body_sensor = of_velodyne ? nclt_body_from_velodyne() : Pose();
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const std::vector<double>& r = table.rows[i];
      const Nanoseconds stamp = stamp_of_row(file, table, i, 1000);
      const Pose T_world_body(from_roll_pitch_yaw(r[4], r[5], r[6]),
                              Eigen::Vector3d(r[1], r[2], r[3]));
      truth.push_back({stamp, nclt_flip() * T_world_body * T_body_sensor * nclt_flip()});
    }
    info.notes.push_back("Ground truth is " + file.filename().string() + ", turned to z upward" +
                         (of_velodyne ? " and brought to the LiDAR." : "."));
    if (table.without_numbers > 0) {
      info.notes.push_back(std::to_string(table.without_numbers) +
                           " rows of ground truth are NaN and left out.");
    }
    return truth;
  }
  return {};
}

class SyncRecording final : public ScanFiles {
 public:
  SyncRecording(const fs::path& path, const RecordingOptions& options)
      : ScanFiles(path, "nclt", path / "velodyne_sync", ".bin", options) {
    take_stamps_from_names(1000, "us");
    check_lengths(kHit, kFields);
    info_.sensor = "Velodyne HDL-32E";
    describe_hits(info_);
    info_.point_times = "none";
    info_.notes.emplace_back("Scans of velodyne_sync are taken as deskewed, in the body's frame.");
    ground_truth_ = read_truth(path, false, info_);
  }

 private:
  std::size_t decode(std::size_t index, Scan& scan) override {
    const std::size_t count = record_count(index, kHit, kFields);
    for (std::size_t i = 0; i < count; ++i)
      (void)append_hit(buffer_.data() + i * kHit, attributes_, scan);
    return count;
  }
};

class HitsRecording final : public Recording {
 public:
  HitsRecording(const fs::path& path, const RecordingOptions& options)
      : file_(path / "velodyne_hits.bin"),
        in_(std::fopen(file_.c_str(), "rb"), &std::fclose),
        attributes_(options.attributes) {
    if (!in_) throw InputError(file_.string() + ": cannot be opened; check its permissions");
    info_.path = path.string();
    info_.format = "nclt";
    info_.sensor = "Velodyne HDL-32E";
    describe_hits(info_);
    info_.point_times = "packet times (us), hits spread evenly to the next packet";
    info_.stamp_source = "first packet of each turn (us)";
    index_turns();
    ground_truth_ = read_truth(path, true, info_);
  }

  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return turns_.size(); }
  Nanoseconds stamp(std::size_t index) const override { return turns_.at(index).stamp; }
  Trajectory ground_truth() const override { return ground_truth_; }

  Scan read(std::size_t index) override {
    const Turn& turn = turns_.at(index);
    buffer_.resize(turn.bytes);
    if (::fseeko(in_.get(), static_cast<off_t>(turn.offset), SEEK_SET) != 0 ||
        std::fread(buffer_.data(), 1, turn.bytes, in_.get()) != turn.bytes) {
      throw InputError(file_.string() + ": ended while it was read; is it being written?");
    }
    Scan scan;
    scan.stamp = turn.stamp;
    std::size_t seen = 0;
    for (std::size_t at = 0; at < buffer_.size();) {
      const Packet packet = header(buffer_.data() + at);
      const std::size_t next = at + kPacketHeader + packet.hits * kHit;
      const std::int64_t turn_utime = turn.stamp / 1000;
      const double begin = 1e-6 * static_cast<double>(packet.utime - turn_utime);
      const double step = packet_seconds_ / static_cast<double>(std::max(packet.hits, 1U));
      for (std::uint32_t i = 0; i < packet.hits; ++i, ++seen) {
        if (append_hit(buffer_.data() + at + kPacketHeader + i * kHit, attributes_, scan))
          scan.times.push_back(static_cast<float>(begin + step * i));
      }
      at = next;
    }
    require_points(scan, seen, file_.string() + ": turn " + std::to_string(index));
    return scan;
  }

 private:
  struct Packet {
    std::uint32_t hits = 0;
    Nanoseconds utime = 0;
    bool magic = false;
  };
  struct Turn {
    std::uint64_t offset = 0;
    std::size_t bytes = 0;
    Nanoseconds stamp = 0;
  };

  static Packet header(const std::byte* at) {
    Packet packet;
    std::uint16_t magic[4];
    std::memcpy(magic, at, sizeof magic);
    std::memcpy(&packet.hits, at + 8, sizeof packet.hits);
    std::memcpy(&packet.utime, at + 12, sizeof packet.utime);
    packet.magic = std::all_of(magic, magic + 4, [](std::uint16_t m) { return m == kNcltMagic; });
    return packet;
  }

  // The packet at `offset` and its hits; false where the file ends within it.
  bool next_packet(std::uint64_t offset, std::uint64_t size, Packet& packet) {
    buffer_.resize(kPacketHeader);
    if (offset + kPacketHeader > size ||
        std::fread(buffer_.data(), 1, kPacketHeader, in_.get()) != kPacketHeader) {
      return false;
    }
    packet = header(buffer_.data());
    if (!packet.magic || packet.hits > kMostHits || packet.utime < 0 ||
        packet.utime > kFarthestStamp / 1000) {
      throw InputError(file_.string() + ": byte " + std::to_string(offset) +
                       ": no packet of NCLT begins here; the file is broken or of another format");
    }
    buffer_.resize(packet.hits * kHit);
    return offset + kPacketHeader + buffer_.size() <= size &&
           std::fread(buffer_.data(), 1, buffer_.size(), in_.get()) == buffer_.size();
  }

  // Azimuth of the first return among the hits in buffer_, `otherwise` where there is none.
  double first_azimuth(double otherwise) const {
    Eigen::Vector3f p;
    for (std::size_t at = 0; at < buffer_.size(); at += kHit) {
      if (decode_hit(buffer_.data() + at, p)) {
        return std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x()));
      }
    }
    return otherwise;
  }

  // Cuts the stream of packets where the azimuth has gone once around.
  void index_turns() {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    std::error_code error;
    const std::uint64_t size = fs::file_size(file_, error);
    double last_azimuth = 0.0, turned = 0.0;
    Nanoseconds last_utime = 0;
    std::vector<Nanoseconds> steps;
    std::uint64_t offset = 0;
    Packet packet;
    while (next_packet(offset, size, packet)) {
      const bool first = turns_.empty();
      const double azimuth = first_azimuth(last_azimuth);
      if (!first) {
        if (packet.utime < last_utime) ++info_.out_of_order;
        steps.push_back(packet.utime - last_utime);
        turned += std::remainder(azimuth - last_azimuth, kTurn);
      }
      last_utime = packet.utime;
      last_azimuth = azimuth;
      // Coordinates in steps of 5 mm make an azimuth uncertain by milliradians.
      if (first || std::abs(turned) >= kTurn - kAzimuthError) {
        if (!first) turned -= std::copysign(kTurn, turned);
        turns_.push_back({offset, 0, packet.utime * 1000});
      }
      const std::size_t bytes = kPacketHeader + packet.hits * kHit;
      turns_.back().bytes += bytes;
      offset += bytes;
    }
    if (offset < size) {
      info_.warnings.emplace_back("The file is cut off within its last packet, which is left out.");
    }
    finish_index(steps);
  }

  // Drops turns whose stamps do not increase and counts gaps.
  void finish_index(std::vector<Nanoseconds>& steps) {
    if (turns_.empty()) throw InputError(file_.string() + ": holds no packet");
    std::vector<Turn> kept;
    for (const Turn& turn : turns_) {
      if (!kept.empty() && turn.stamp <= kept.back().stamp) {
        ++info_.dropped_scans;
        continue;
      }
      kept.push_back(turn);
    }
    turns_ = std::move(kept);
    std::vector<Nanoseconds> stamps;
    for (const Turn& turn : turns_) stamps.push_back(turn.stamp);
    info_.gaps = count_gaps(stamps);
    if (steps.empty()) return;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    packet_seconds_ = 1e-6 * static_cast<double>(std::clamp<Nanoseconds>(*middle, 0, 10'000));
  }

  fs::path file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> in_;
  RecordingInfo info_;
  std::vector<Turn> turns_;
  double packet_seconds_ = 0.0;
  Trajectory ground_truth_;
  std::vector<std::byte> buffer_;
  AttributeSet attributes_;
};

}  // namespace

bool is_nclt(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path / "velodyne_sync", error) ||
         fs::is_regular_file(path / "velodyne_hits.bin", error);
}

std::unique_ptr<Recording> open_nclt(const fs::path& path, const RecordingOptions& options) {
  const std::string& stream = options.topic;
  std::error_code error;
  const bool hits = fs::is_regular_file(path / "velodyne_hits.bin", error);
  const bool sync = fs::is_directory(path / "velodyne_sync", error);
  if ((stream == "velodyne_hits" || (stream.empty() && hits)) && hits) {
    return std::make_unique<HitsRecording>(path, options);
  }
  if ((stream == "velodyne_sync" || stream.empty()) && sync) {
    return std::make_unique<SyncRecording>(path, options);
  }
  throw InputError(path.string() + ": has no '" + stream +
                   "'; choose velodyne_hits or velodyne_sync with --topic");
}

}  // namespace groundloop::recordings
