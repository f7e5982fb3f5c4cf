// The map of many local maps, put together and written to a file.
#include <filesystem>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "backend/map/map_assembly.hpp"
#include "frontend/core/pcd.hpp"
#include "tests/support/street_scene.hpp"

namespace groundloop {
namespace {

namespace fs = std::filesystem;

constexpr int kMaps = 8;
constexpr std::size_t kPoints = 150'000;  // of a local map

// One scene seen eight times, 50 m farther along each time.
void assemble_and_export(benchmark::State& state, const std::string& ending) {
  const fs::path folder =
      fs::temp_directory_path() / ("groundloop_map_" + std::to_string(::getpid()) + ending);
  fs::create_directories(folder);
  const Points points = testing::StreetScene(1).sample(kPoints, 0.02, 1);
  std::vector<MapPiece> pieces;
  for (int i = 0; i < kMaps; ++i) {
    const fs::path file = folder / (std::to_string(i) + ".pcd");
    write_pcd(file, points);
    Pose T_world_map;
    T_world_map.translation.x() = 50.0 * i;
    pieces.push_back(rigid_piece(file, T_world_map));
  }
  std::uint64_t written = 0;
  for (auto _ : state) {
    const auto writer = open_point_cloud_writer(folder / ("map." + ending), {});
    written = assemble_map(pieces, {}, *writer, folder);
    writer->finish();
  }
  state.counters["points_read/s"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * kMaps * kPoints, benchmark::Counter::kIsRate);
  state.counters["points_written"] = static_cast<double>(written);
  fs::remove_all(folder);
}
BENCHMARK_CAPTURE(assemble_and_export, pcd, std::string("pcd"))
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(assemble_and_export, ply, std::string("ply"))
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(assemble_and_export, las, std::string("las"))
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace groundloop
