// Scans a second of the simulation, per sensor. The first scan, which builds the scenery around
// the start, is not counted; scenery met on the way is.
#include <benchmark/benchmark.h>

#include "frontend/simulation/simulation.hpp"

namespace groundloop {
namespace {

void simulate(benchmark::State& state, const char* specification) {
  const auto recording = open_simulation(specification);
  std::size_t scan = 0, points = recording->read(0).points.size();
  for (auto _ : state) {
    scan = (scan + 1) % recording->size();
    points = recording->read(scan).points.size();
  }
  state.counters["points"] = static_cast<double>(points);
  state.counters["scans/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(simulate, spin16, "sim:town?sensor=spin16")->UseRealTime();
BENCHMARK_CAPTURE(simulate, spin32, "sim:town?sensor=spin32")->UseRealTime();
BENCHMARK_CAPTURE(simulate, spin64, "sim:town?sensor=spin64")->UseRealTime();
BENCHMARK_CAPTURE(simulate, spin128, "sim:town?sensor=spin128")->UseRealTime();
BENCHMARK_CAPTURE(simulate, raster, "sim:town?sensor=raster")->UseRealTime();
BENCHMARK_CAPTURE(simulate, rosette, "sim:town?sensor=rosette")->UseRealTime();
BENCHMARK_CAPTURE(simulate, bridge, "sim:bridge")->UseRealTime();
BENCHMARK_CAPTURE(simulate, park, "sim:park")->UseRealTime();

}  // namespace
}  // namespace groundloop
