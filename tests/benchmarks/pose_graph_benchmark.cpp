// Pose graphs: the public ones from their files' guesses, and drives of 1 000 to 100 000 poses with
// a closure every 100 poses. Memory is what the process holds more at its peak than before.
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "backend/graph/g2o_file.hpp"
#include "backend/judging/optimizer.hpp"
#include "backend/judging/pairwise_consistency.hpp"
#include "tests/support/false_closures.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

// A field of /proc/self/status in MB.
double memory_mb(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(field + ":", 0) == 0) return std::stod(line.substr(field.size() + 1)) / 1024.0;
  }
  return 0.0;
}

void forget_memory_peak() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

void report(benchmark::State& state, const OptimizationSummary& summary, double memory_before) {
  state.counters["cost"] = summary.cost_after;
  state.counters["iterations"] = summary.iterations;
  state.counters["initialisation_s"] = summary.seconds.initialisation;
  state.counters["robust_s"] = summary.seconds.robust;
  state.counters["solve_s"] = summary.seconds.solve;
  state.counters["memory_mb"] = memory_mb("VmHWM") - memory_before;
}

void optimize_copies(benchmark::State& state, const PoseGraph& graph,
                     const OptimizerOptions& options) {
  OptimizationSummary summary;
  forget_memory_peak();
  const double before = memory_mb("VmRSS");
  for (auto _ : state) {
    state.PauseTiming();
    PoseGraph copy = graph;
    state.ResumeTiming();
    summary = optimize(copy, options);
  }
  report(state, summary, before);
}

void BM_PublicGraph(benchmark::State& state, const std::string& name) {
  const auto file = std::filesystem::path(GROUNDLOOP_SHARED_DATA) / "pose_graphs" / (name + ".g2o");
  if (!std::filesystem::exists(file)) {
    state.SkipWithError("the public pose graphs are not there");
    return;
  }
  optimize_copies(state, read_g2o(file).graph, {});
}
BENCHMARK_CAPTURE(BM_PublicGraph, torus3D, "torus3D")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_PublicGraph, sphere2500, "sphere2500")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_PublicGraph, parking_garage, "parking-garage")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_PublicGraph, sphere_bignoise, "sphere_bignoise_vertex3")
    ->Unit(benchmark::kMillisecond);

void BM_Drive(benchmark::State& state) {
  const int poses = static_cast<int>(state.range(0));
  optimize_copies(state, testing::simulate_graph(poses, poses / 100, poses / 20, 1).graph, {});
}
BENCHMARK(BM_Drive)->Arg(1000)->Arg(3000)->Arg(10000)->Arg(20000)->Arg(30000)->Arg(100000)->Unit(
    benchmark::kMillisecond);

// As many false closures as true ones.
void BM_RobustDrive(benchmark::State& state) {
  const int poses = static_cast<int>(state.range(0));
  testing::SimulatedGraph simulated = testing::simulate_graph(poses, poses / 100, poses / 20, 1);
  testing::FalseClosures(simulated.truth, testing::closure_covariance().inverse(), 2)
      .add_random(simulated.graph, poses / 100, 50);
  OptimizerOptions options;
  options.robust = true;
  optimize_copies(state, simulated.graph, options);
}
BENCHMARK(BM_RobustDrive)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

void BM_PairwiseConsistency(benchmark::State& state) {
  const int closures = static_cast<int>(state.range(0));
  const int lap = 2000;
  const testing::SimulatedGraph simulated = testing::simulate_graph(2 * lap, closures, lap, 1);
  std::vector<Pose> odometry;
  for (const GraphVertex& vertex : simulated.graph.vertices) odometry.push_back(vertex.pose);
  const OdometryChain chain(odometry, testing::simulated_drift());
  std::vector<PairwiseClosure> pairs;
  for (const GraphEdge& edge : simulated.graph.edges) {
    if (edge.kind != EdgeKind::closure) continue;
    pairs.push_back({edge.from, edge.to, {edge.T_from_to, testing::closure_covariance()}});
  }
  const auto between = [&](int from, int to) {
    return chain.between(static_cast<std::size_t>(from), static_cast<std::size_t>(to));
  };
  std::size_t largest = 0;
  for (auto _ : state) largest = consistent_sets(pairs, between, between).sets.front().size();
  state.counters["largest"] = static_cast<double>(largest);
}
BENCHMARK(BM_PairwiseConsistency)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace groundloop
