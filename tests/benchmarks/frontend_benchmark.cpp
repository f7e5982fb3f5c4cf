// Hot stages of the front end on a simulated 64-beam drive: deskewing, downsampling, the voxel map,
// registration of a scan, local maps.
#include <benchmark/benchmark.h>

#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/odometry.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/odometry/voxel_map.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop {
namespace {

const std::vector<Scan>& scans() {
  static const std::vector<Scan> instance = [] {
    RecordingOptions options;
    options.first = 100;
    options.count = 20;
    const auto recording = open_any_recording("sim:town?sensor=spin64&length=500&seed=1", options);
    std::vector<Scan> result;
    for (std::size_t i = 0; i < recording->size(); ++i) result.push_back(recording->read(i));
    return result;
  }();
  return instance;
}

Vector6d driving() {
  Vector6d twist = Vector6d::Zero();
  twist(0) = 8.0;
  twist(5) = 0.1;
  return twist;
}

void BM_DeskewAndCrop(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(deskew_and_crop(scans()[0], {driving()}, 0.05, 0.0, 100.0));
  state.counters["points"] = static_cast<double>(scans()[0].points.size());
}
BENCHMARK(BM_DeskewAndCrop)->Unit(benchmark::kMillisecond);

void BM_Downsample(benchmark::State& state) {
  VoxelDownsampler downsample;
  for (auto _ : state) benchmark::DoNotOptimize(downsample(scans()[0].points, 0.5F));
}
BENCHMARK(BM_Downsample)->Unit(benchmark::kMillisecond);

void BM_VoxelMapInsert(benchmark::State& state) {
  const Points points = VoxelDownsampler()(scans()[0].points, 0.5F);
  for (auto _ : state) {
    VoxelMap map(1.0F);
    map.insert(points, Pose());
    benchmark::DoNotOptimize(map.voxels());
  }
  state.counters["points"] = static_cast<double>(points.size());
}
BENCHMARK(BM_VoxelMapInsert)->Unit(benchmark::kMillisecond);

void BM_VoxelMapNearest(benchmark::State& state) {
  VoxelMap map(1.0F);
  for (const Scan& scan : scans()) map.insert(VoxelDownsampler()(scan.points, 0.5F), Pose());
  const Points queries = VoxelDownsampler()(scans()[1].points, 1.0F);
  const MapAnchor anchor = map.anchor_at(Eigen::Vector3d::Zero());
  for (auto _ : state) {
    float sum = 0.0F;
    for (const Eigen::Vector3f& p : queries) sum += map.nearest(anchor, p, 1.0F).squared_distance;
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * queries.size()));
}
BENCHMARK(BM_VoxelMapNearest)->Unit(benchmark::kMillisecond);

// Whole odometry of 20 successive scans, per scan.
void BM_Odometry(benchmark::State& state) {
  OdometryOptions options;
  options.point_to_point = state.range(0) != 0;
  for (auto _ : state) {
    Odometry odometry(options);
    odometry.start(scans()[0], scans()[1]);
    for (const Scan& scan : scans())
      benchmark::DoNotOptimize(odometry.add(scan, "scan").T_world_scan);
  }
  state.counters["scans/s"] = benchmark::Counter(
      static_cast<double>(state.iterations() * scans().size()), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_Odometry)
    ->Arg(0)
    ->Arg(1)
    ->ArgName("point_to_point")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void BM_LocalMap(benchmark::State& state) {
  for (auto _ : state) {
    LocalMapBuilder builder{LocalMapOptions{}};
    for (const Scan& scan : scans()) benchmark::DoNotOptimize(builder.add(scan.points, Pose()));
    benchmark::DoNotOptimize(builder.finish());
  }
  state.counters["scans/s"] = benchmark::Counter(
      static_cast<double>(state.iterations() * scans().size()), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_LocalMap)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace groundloop
