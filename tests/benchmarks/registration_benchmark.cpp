// Verification of one loop-closure candidate, by stage, on maps the size of local maps.
#include <benchmark/benchmark.h>

#include "backend/mapping/map_quality.hpp"
#include "backend/registration/overlap.hpp"
#include "backend/registration/verification.hpp"
#include "tests/support/street_scene.hpp"

namespace groundloop {
namespace {

struct Maps {
  explicit Maps(std::size_t n)
      : query(testing::StreetScene(1).sample(n, 0.02, 1)),
        reference(testing::StreetScene(1).sample(n, 0.02, 2)) {
    Vector6d xi;
    xi << 1.0, 0.5, 0.2, 0.0, 0.0, 0.03;
    T_start = exp_se3(xi);
  }
  Points query, reference;
  Pose T_start;
};

void target_of_a_map(benchmark::State& state) {
  const Maps maps(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(RegistrationTarget(maps.query, {}));
}

void register_maps(benchmark::State& state) {
  const Maps maps(static_cast<std::size_t>(state.range(0)));
  const RegistrationTarget target(maps.query, {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(register_points(target, maps.reference, maps.T_start));
  }
}

void overlap_of_maps(benchmark::State& state) {
  const Maps maps(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(volumetric_overlap(maps.reference, maps.query, Pose()));
  }
}

void verify_candidate(benchmark::State& state) {
  const Maps maps(static_cast<std::size_t>(state.range(0)));
  const RegistrationTarget target(maps.query, {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(verify_closure(target, maps.query, maps.reference, maps.T_start));
  }
}

void quality_of_a_revisit(benchmark::State& state) {
  const Maps maps(static_cast<std::size_t>(state.range(0)));
  const RegistrationTarget target(maps.query, {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(revisit_quality(target, maps.query, maps.reference, Pose()));
  }
}

BENCHMARK(target_of_a_map)
    ->Arg(50'000)
    ->Arg(150'000)
    ->Arg(400'000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(register_maps)
    ->Arg(50'000)
    ->Arg(150'000)
    ->Arg(400'000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(overlap_of_maps)
    ->Arg(50'000)
    ->Arg(150'000)
    ->Arg(400'000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(verify_candidate)
    ->Arg(50'000)
    ->Arg(150'000)
    ->Arg(400'000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(quality_of_a_revisit)->Arg(150'000)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace groundloop
