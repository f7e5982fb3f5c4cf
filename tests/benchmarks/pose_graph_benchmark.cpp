// Pose graphs: the public ones from their files' guesses, and drives of 1 000 to 100 000 poses with
// a closure every 100 poses. Memory is what the process holds more at its peak than before.
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "backend/graph/g2o_file.hpp"
#include "backend/judging/odometry_scale.hpp"
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

// The key poses of a recording: one a local map of 100 m, ten laps around a circuit, odometry that
// errs as it says, and closures between a place and the same one, or its neighbour, laps before.
testing::SimulatedGraph simulate_key_poses(int maps, int closures, std::uint64_t seed) {
  constexpr int kMetres = 100, kLaps = 10;
  const int lap = maps / kLaps;
  std::mt19937_64 generator(seed);
  testing::SimulatedGraph result;
  const Matrix6d closure_covariance = testing::closure_covariance();
  std::vector<Pose> way(kMetres + 1);
  for (int m = 0; m < maps; ++m) {
    const double s = kMetres * m;
    result.truth.push_back(testing::circuit_pose(s, kMetres * lap));
    if (m == 0) {
      result.graph.vertices.push_back({0, result.truth[0], true});
      continue;
    }
    for (int i = 0; i <= kMetres; ++i)
      way[static_cast<std::size_t>(i)] = testing::circuit_pose(s - kMetres + i, kMetres * lap);
    const RelativePose step = compose_odometry(way, 0, kMetres, testing::simulated_drift());
    GraphEdge edge;
    edge.from = m - 1;
    edge.to = m;
    edge.T_from_to = step.T_from_to * exp_se3(testing::gaussian(generator, step.covariance));
    edge.information = step.covariance.inverse();
    edge.information = (0.5 * (edge.information + edge.information.transpose())).eval();
    result.graph.vertices.push_back({m, result.graph.vertices.back().pose * edge.T_from_to, false});
    result.graph.edges.push_back(edge);
  }
  for (int k = 0; k < closures; ++k) {
    GraphEdge edge;
    edge.kind = EdgeKind::closure;
    edge.from = lap + static_cast<int>(generator() % static_cast<std::uint64_t>(maps - lap));
    const int laps =
        1 + static_cast<int>(generator() % static_cast<std::uint64_t>(edge.from / lap));
    edge.to = std::max(0, edge.from - laps * lap + static_cast<int>(generator() % 3) - 1);
    edge.T_from_to = result.truth[edge.from].inverse() * result.truth[edge.to] *
                     exp_se3(testing::gaussian(generator, closure_covariance));
    edge.information = closure_covariance.inverse();
    result.graph.edges.push_back(edge);
  }
  return result;
}

// All that is decided on the graph of key poses: how much odometry errs, which closures agree, and
// which hold; one in twenty is false.
void BM_KeyPoses(benchmark::State& state) {
  const int maps = static_cast<int>(state.range(0));
  const int closures = static_cast<int>(state.range(1));
  testing::SimulatedGraph simulated = simulate_key_poses(maps, closures, 1);
  const std::size_t first_false = simulated.graph.edges.size();
  testing::FalseClosures(simulated.truth, testing::closure_covariance().inverse(), 2)
      .add_random(simulated.graph, closures / 20, 4);
  OptimizerOptions options;
  options.robust = true;
  OptimizationSummary summary;
  testing::Verdicts verdicts;
  double scale = 0.0;
  forget_memory_peak();
  const double before = memory_mb("VmRSS");
  for (auto _ : state) {
    PoseGraph graph = simulated.graph;
    scale = estimate_odometry_scale(graph).scale;
    scale_odometry(graph, scale);
    summary = optimize(graph, options);
    verdicts = testing::count_verdicts(graph, first_false);
  }
  report(state, summary, before);
  state.counters["scale"] = scale;
  state.counters["false_kept"] = verdicts.false_kept;
  state.counters["true_rejected"] = verdicts.true_rejected;
}
BENCHMARK(BM_KeyPoses)
    ->Args({100, 500})
    ->Args({300, 1500})
    ->Args({1000, 5000})
    ->Iterations(1)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

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
