// NCLT's layout: the packets of velodyne_hits.bin where points have times, else velodyne_sync.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/simulation/layouts/byte_writer.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"

namespace groundloop::layouts {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostHits = 384;  // an HDL-32E's packet

class NcltWriter final : public Writer {
 public:
  NcltWriter(const fs::path& folder, const Source& source) : folder_(folder), source_(source) {}

  void write(std::size_t index, const Scan& scan) override {
    if (scan.stamp < 0) throw InputError("NCLT's layout cannot hold stamps before 1970");
    if (index == 0) {
      timed_ = !scan.times.empty();
      if (timed_) {
        hits_.open(folder_ / "velodyne_hits.bin", std::ios::binary | std::ios::trunc);
      } else {
        fs::create_directories(folder_ / "velodyne_sync");
      }
      write_ground_truth();
    }
    timed_ ? write_packets(scan) : write_sync(scan);
  }

  void finish() override {
    if (timed_ && !hits_.flush()) {
      throw InputError((folder_ / "velodyne_hits.bin").string() +
                       ": cannot be written; is the disk full?");
    }
  }

 private:
  // Back to the frame of the sensor that hangs upside down; false beyond what 16 bits hold.
  static bool put_hit(ByteWriter& bytes, const Eigen::Vector3f& p) {
    std::uint16_t raw[3];
    const double metres[3] = {static_cast<double>(p.x()), -static_cast<double>(p.y()),
                              -static_cast<double>(p.z())};
    for (int k = 0; k < 3; ++k) {
      const double units =
          std::round((metres[k] - recordings::kNcltOffset) / recordings::kNcltScale);
      if (!(units >= 0.0 && units <= 65535.0)) return false;
      raw[k] = static_cast<std::uint16_t>(units);
    }
    bytes.put(raw[0]).put(raw[1]).put(raw[2]).put<std::uint8_t>(0).put<std::uint8_t>(0);
    return true;
  }

  void write_sync(const Scan& scan) {
    ByteWriter bytes;
    for (const Eigen::Vector3f& p : scan.points) put_hit(bytes, p);
    write_bytes(folder_ / "velodyne_sync" / (std::to_string(scan.stamp / 1000) + ".bin"),
                bytes.view());
  }

  // One packet for each microsecond at which there are points.
  void write_packets(const Scan& scan) {
    std::vector<std::size_t> order(scan.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return scan.times[a] < scan.times[b]; });
    const auto utime = [&](std::size_t i) {
      return scan.stamp / 1000 + std::llround(static_cast<double>(scan.times[i]) * 1e6);
    };
    ByteWriter hits, packet;
    for (std::size_t begin = 0; begin < order.size();) {
      const Nanoseconds time = utime(order[begin]);
      std::size_t end = begin;
      hits.clear();
      while (end < order.size() && end - begin < kMostHits && utime(order[end]) == time) {
        put_hit(hits, scan.points[order[end++]]);
      }
      packet.clear();
      for (int i = 0; i < 4; ++i) packet.put(recordings::kNcltMagic);
      packet.put(static_cast<std::uint32_t>(hits.size() / 8)).put(time).put<std::uint32_t>(0);
      packet.put_text(hits.view());
      hits_.write(packet.view().data(), static_cast<std::streamsize>(packet.size()));
      begin = end;
    }
  }

  void write_ground_truth() const {
    if (source_.ground_truth.empty()) return;
    const Pose T_sensor_body = timed_ ? recordings::nclt_body_from_velodyne().inverse() : Pose();
    std::string text;
    for (const StampedPose& sample : source_.ground_truth) {
      const Pose T_world_body =
          recordings::nclt_flip() * sample.pose * recordings::nclt_flip() * T_sensor_body;
      const Eigen::Matrix3d r = T_world_body.rotation_matrix();
      const double roll = std::atan2(r(2, 1), r(2, 2));
      const double pitch = std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2)));
      const double heading = std::atan2(r(1, 0), r(0, 0));
      text += std::to_string(sample.stamp / 1000);
      for (const double v : {T_world_body.translation.x(), T_world_body.translation.y(),
                             T_world_body.translation.z(), roll, pitch, heading}) {
        text += "," + to_text(v);
      }
      text += "\n";
    }
    write_bytes(folder_ / "groundtruth_simulated.csv", text);
  }

  fs::path folder_;
  Source source_;
  bool timed_ = false;
  std::ofstream hits_;
};

}  // namespace

std::unique_ptr<Writer> make_nclt_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<NcltWriter>(folder, source);
}

}  // namespace groundloop::layouts
