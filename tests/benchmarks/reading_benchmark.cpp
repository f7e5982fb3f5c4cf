// How fast scans of a full 64-beam sensor (120 000 points) come from each layout, decoded, from the
// page cache.
#include <cmath>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;

class Full final : public Recording {
 public:
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return 10; }
  Nanoseconds stamp(std::size_t index) const override {
    return 1'700'000'000'000'000'000 + static_cast<Nanoseconds>(index) * 100'000'000;
  }
  Scan read(std::size_t index) override {
    Scan scan;
    scan.stamp = stamp(index);
    for (int i = 0; i < 120'000; ++i) {
      const double azimuth = 1e-4 * i, range = 5.0 + 0.3 * (i % 97);
      scan.points.emplace_back(static_cast<float>(range * std::cos(azimuth)),
                               static_cast<float>(range * std::sin(azimuth)),
                               static_cast<float>(0.01 * (i % 64)));
      scan.times.push_back(static_cast<float>(8e-7 * i));
    }
    return scan;
  }

 private:
  RecordingInfo info_;
};

void read_layout(benchmark::State& state, const std::string& layout) {
  const fs::path folder =
      fs::temp_directory_path() / ("groundloop_reading_" + std::to_string(::getpid()) + layout);
  Full full;
  write_layout(full, layout, folder);
  const auto recording = open_any_recording(folder.string());
  std::size_t index = 0, points = 0;
  for (auto _ : state) {
    const Scan scan = recording->read(index++ % recording->size());
    points += scan.points.size();
  }
  state.counters["scans/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["points/s"] =
      benchmark::Counter(static_cast<double>(points), benchmark::Counter::kIsRate);
  fs::remove_all(folder);
}

BENCHMARK_CAPTURE(read_layout, kitti, std::string("kitti"));
BENCHMARK_CAPTURE(read_layout, helipr, std::string("helipr"));
BENCHMARK_CAPTURE(read_layout, rosbag, std::string("rosbag"));
BENCHMARK_CAPTURE(read_layout, rosbag2, std::string("rosbag2"));
BENCHMARK_CAPTURE(read_layout, mcap, std::string("mcap"));
BENCHMARK_CAPTURE(read_layout, folder, std::string("folder"));

}  // namespace
}  // namespace groundloop
