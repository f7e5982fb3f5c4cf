// The stages of loop closing, one benchmark each, on a made-up town block of 200 000 points; the
// database at 10 to 10 000 local maps: built, saved, loaded, searched; and, where
// GROUNDLOOP_SESSION names a session's folder, all stages on its local maps, one after the other on
// one core.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "frontend/core/pcd.hpp"
#include "loopclosure/consensus.hpp"
#include "loopclosure/density_image.hpp"
#include "loopclosure/describe.hpp"
#include "loopclosure/features.hpp"
#include "loopclosure/ground_alignment.hpp"
#include "loopclosure/hamming.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace {

const Points& town() {
  static const Points points = [] {
    std::mt19937_64 rng(1);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    Points result;
    for (int i = 0; i < 100000; ++i) {
      result.emplace_back(-100 + 200 * unit(rng), -100 + 200 * unit(rng), -1.7F);
    }
    while (result.size() < 200000) {
      const Eigen::Vector2f from(-90 + 180 * unit(rng), -90 + 180 * unit(rng));
      const float angle = 6.28F * unit(rng), length = 4 + 16 * unit(rng),
                  height = 2 + 8 * unit(rng);
      for (int i = 0; i < static_cast<int>(length * height * 20); ++i) {
        const Eigen::Vector2f p =
            from + Eigen::Vector2f(std::cos(angle), std::sin(angle)) * length * unit(rng);
        result.emplace_back(p.x(), p.y(), -1.7F + height * unit(rng));
      }
    }
    return result;
  }();
  return points;
}

void ground_alignment(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(align_to_ground(town(), {}));
}
BENCHMARK(ground_alignment)->Unit(benchmark::kMillisecond);

void density_image(benchmark::State& state) {
  const Pose T = align_to_ground(town(), {}).T_ground_map;
  for (auto _ : state) benchmark::DoNotOptimize(make_density_image(town(), T, {}));
}
BENCHMARK(density_image)->Unit(benchmark::kMillisecond);

void features_and_pruning(benchmark::State& state) {
  const DensityImage image =
      make_density_image(town(), align_to_ground(town(), {}).T_ground_map, {});
  for (auto _ : state) benchmark::DoNotOptimize(extract_features(image, {}));
}
BENCHMARK(features_and_pruning)->Unit(benchmark::kMillisecond);

void hamming_kernel(benchmark::State& state) {
  const HammingKernel kernel = hamming_kernels().at(static_cast<std::size_t>(state.range(0)));
  state.SetLabel(std::string(kernel.name));
  std::mt19937_64 rng(2);
  std::vector<Descriptor> stored(4096);
  for (Descriptor& d : stored) d = {rng(), rng(), rng(), rng()};
  std::vector<std::uint16_t> distances(stored.size());
  for (auto _ : state) {
    kernel.distances(stored[0], stored.data(), nullptr, stored.size(), distances.data());
    benchmark::DoNotOptimize(distances.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * 4096);
}
BENCHMARK(hamming_kernel)->DenseRange(0, static_cast<int>(hamming_kernels().size()) - 1);

// Descriptors as ORB gives them are far from random: bits follow one another. Maps are made of a
// common vocabulary of 20 000 words with noise, and a query is map 0 with noise again.
MapDescription made_up_map(int map, std::mt19937_64& rng, const std::vector<Descriptor>& words) {
  MapDescription d;
  d.key = {0, map};
  for (int i = 0; i < 500; ++i) {
    Descriptor word = words[rng() % words.size()];
    for (int flips = 0; flips < 60; ++flips) {
      const std::size_t bit = rng() % 256;
      word[bit / 64] ^= 1ULL << (bit % 64);
    }
    d.descriptors.push_back(word);
    d.keypoints.emplace_back(static_cast<float>(rng() % 2000) * 0.1F,
                             static_cast<float>(rng() % 2000) * 0.1F);
    d.orientations.push_back(static_cast<float>(rng() % 628) * 0.01F);
  }
  return d;
}

struct Database {
  LoopDatabase maps{LoopClosureOptions{}};
  MapDescription query;
  explicit Database(int count) {
    std::mt19937_64 rng(3);
    std::vector<Descriptor> words(20000);
    for (Descriptor& d : words) d = {rng(), rng(), rng(), rng()};
    for (int map = 0; map < count; ++map) maps.insert(made_up_map(map, rng, words));
    query = maps.descriptions().front();
    query.key = {1, 0};
    for (Descriptor& d : query.descriptors) {
      for (int flips = 0; flips < 20; ++flips) {
        const std::size_t bit = rng() % 256;
        d[bit / 64] ^= 1ULL << (bit % 64);
      }
    }
  }
};

const Database& database(int count) {
  static std::unique_ptr<Database> last;
  static int last_count = -1;
  if (last_count != count) {
    last.reset();
    last = std::make_unique<Database>(count);
    last_count = count;
  }
  return *last;
}

void match_one_map(benchmark::State& state) {
  const Database& d = database(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(d.maps.match(d.query));
}
BENCHMARK(match_one_map)->Arg(10)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

void query_one_map(benchmark::State& state) {
  const Database& d = database(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(d.maps.query(d.query));
}
BENCHMARK(query_one_map)->Arg(10)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

// All maps of a database entered one after the other, from descriptions at hand.
void build_database(benchmark::State& state) {
  const Database& d = database(static_cast<int>(state.range(0)));
  double bytes = 0.0;
  for (auto _ : state) {
    const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
    LoopDatabase maps{LoopClosureOptions{}};
    for (const MapDescription& map : d.maps.descriptions()) maps.insert(map);
    bytes = static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd - before);
  }
  state.counters["bytes_a_map"] = bytes / static_cast<double>(state.range(0));
}
BENCHMARK(build_database)->Arg(10)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

std::filesystem::path database_file() {
  return std::filesystem::temp_directory_path() / "groundloop_loop_database_benchmark.bin";
}

void save_database(benchmark::State& state) {
  const Database& d = database(static_cast<int>(state.range(0)));
  for (auto _ : state) d.maps.save(database_file());
  state.counters["bytes_a_map"] = static_cast<double>(std::filesystem::file_size(database_file())) /
                                  static_cast<double>(state.range(0));
}
BENCHMARK(save_database)->Arg(10)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

void load_database(benchmark::State& state) {
  database(static_cast<int>(state.range(0))).maps.save(database_file());
  for (auto _ : state) {
    benchmark::DoNotOptimize(LoopDatabase::load(database_file(), LoopClosureOptions{}));
  }
  std::filesystem::remove(database_file());
}
BENCHMARK(load_database)->Arg(10)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

void consensus(benchmark::State& state) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> place(-80, 80), turn(-3, 3);
  MapDescription query, reference;
  std::vector<KeypointMatch> matches;
  const PlanarTransform T{0.7, {10, -5}};
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(state.range(0)); ++i) {
    const Eigen::Vector2d r(place(rng), place(rng));
    const bool inlier = i % 5 == 0;
    reference.keypoints.push_back(r.cast<float>());
    reference.orientations.push_back(static_cast<float>(turn(rng)));
    query.keypoints.push_back(
        (inlier ? T * r : Eigen::Vector2d(place(rng), place(rng))).cast<float>());
    query.orientations.push_back(inlier ? reference.orientations.back() + 0.7F
                                        : static_cast<float>(turn(rng)));
    reference.descriptors.push_back({rng(), rng(), rng(), rng()});
    query.descriptors.push_back(reference.descriptors.back());
    matches.push_back({i, i, 0});
  }
  for (auto _ : state) benchmark::DoNotOptimize(find_consensus(query, reference, matches, {}));
}
BENCHMARK(consensus)->Arg(20)->Arg(100)->Arg(300)->Unit(benchmark::kMicrosecond);

std::vector<Points> session_maps(const std::filesystem::path& session) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(session / "local_maps")) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Points> maps;
  maps.reserve(files.size());
  for (const std::filesystem::path& file : files) maps.push_back(read_pcd(file));
  return maps;
}

// Mean and standard deviation of what each of a series of maps took.
class StageStatistics {
 public:
  void add(double seconds) {
    sum_ += seconds;
    squares_ += seconds * seconds;
    ++count_;
  }
  void put(benchmark::State& state, const std::string& name) const {
    const double mean = sum_ / count_;
    state.counters[name + "_ms"] = 1e3 * mean;
    state.counters[name + "_std_ms"] =
        1e3 * std::sqrt(std::max(0.0, squares_ / count_ - mean * mean));
  }

 private:
  double sum_ = 0.0, squares_ = 0.0, count_ = 0.0;
};

// As in a run: each map described, sought in the database of those before it, and entered. The
// counters are milliseconds of processor time a map.
void stages_of_a_session(benchmark::State& state) {
  const char* session = std::getenv("GROUNDLOOP_SESSION");
  if (session == nullptr) {
    state.SkipWithError("GROUNDLOOP_SESSION is not set");
    return;
  }
  const std::vector<Points> maps = session_maps(session);
  StageStatistics ground, image, features, matching, consensus, all;
  std::size_t candidates = 0, inliers = 0;
  for (auto _ : state) {
    LoopDatabase database{LoopClosureOptions{}};
    candidates = inliers = 0;
    for (std::size_t m = 0; m < maps.size(); ++m) {
      LoopClosureTimes times;
      MapDescription description =
          describe_map({0, static_cast<int>(m)}, maps[m], LoopClosureOptions{}, &times);
      for (const ClosureCandidate& candidate : database.query(description, &times)) {
        ++candidates;
        inliers += static_cast<std::size_t>(candidate.inliers);
      }
      database.insert(std::move(description));
      ground.add(times.ground_alignment);
      image.add(times.density_image);
      features.add(times.features);
      matching.add(times.matching);
      consensus.add(times.consensus);
      all.add(times.ground_alignment + times.density_image + times.features + times.matching +
              times.consensus);
    }
  }
  ground.put(state, "1_ground");
  image.put(state, "2_image");
  features.put(state, "3_features");
  matching.put(state, "4_matching");
  consensus.put(state, "5_consensus");
  all.put(state, "6_all");
  state.counters["candidates"] = static_cast<double>(candidates);
  state.counters["inliers"] = static_cast<double>(inliers);
}
BENCHMARK(stages_of_a_session)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace groundloop
