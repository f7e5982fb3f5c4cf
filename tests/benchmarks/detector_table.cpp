// The detector alone on simulated recordings, as a table in Markdown: local maps of true poses with
// a drift put on them, so that neither odometry nor verification has a part in the figures, in
// several configurations. Reference closures and errors are those of `groundloop evaluate
// closures`.
//
//   groundloop_detector_table [--spacing M] [--drift FACTOR] [--only CONFIGURATION]... SIM...
//
// Scans are taken SPACING (2) metres apart. Drift, at a factor of 1: yaw walks by 0.5 degrees and
// roll and pitch by 0.15 degrees in 100 m (standard deviation), and steps are 0.4 % too long.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "frontend/core/error.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/preprocessing.hpp"
#include "frontend/simulation/simulation.hpp"
#include "loopclosure/describe.hpp"
#include "loopclosure/evaluation/evaluation.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace {

struct SimulatedMaps {
  std::vector<EvaluatedMap> truth;  // in the frames of their first scans
  std::vector<Points> drifted;      // what a detector is given
  double length = 0.0, end_error = 0.0;
};

class Drift {
 public:
  Drift(std::uint64_t seed, double factor) : rng_(seed), factor_(factor) {}
  Pose step(const Pose& truth) {
    const double per_metre = std::numbers::pi / 180 / 10 * std::sqrt(truth.translation.norm());
    const Eigen::Vector3d turn(0.15 * normal_(rng_), 0.15 * normal_(rng_), 0.5 * normal_(rng_));
    return Pose(exp_so3(factor_ * per_metre * turn) * truth.rotation,
                (1 + 0.004 * factor_) * truth.translation);
  }

 private:
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  double factor_;
};

Points points_of(const Scan& scan, const Trajectory& truth, std::size_t i) {
  const std::size_t a = i + 1 < truth.size() ? i : i - 1;
  const double seconds = 1e-9 * static_cast<double>(truth[a + 1].stamp - truth[a].stamp);
  const Vector6d twist = log_se3(truth[a].pose.inverse() * truth[a + 1].pose) / seconds;
  return deskew_and_crop(scan, {twist}, 0.0, 0.0, 100.0);
}

SimulatedMaps build_maps(const std::string& recording_name, double spacing, double drift_factor) {
  const auto recording = open_simulation(recording_name);
  const Trajectory truth = recording->ground_truth();
  SimulatedMaps maps;
  std::uint64_t seed = 0xcbf29ce484222325ULL;  // FNV-1a of the name
  for (const char c : recording_name) {
    seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  Drift drift(seed, drift_factor);
  LocalMapBuilder estimated{LocalMapOptions{}};
  LocalMapOptions whole;
  whole.length = 1e4;
  whole.max_path = 1e5;
  LocalMapBuilder exact(whole);
  EvaluatedMap current;
  const auto finish = [&](LocalMap map) {
    maps.drifted.push_back(std::move(map.points));
    current.key = {0, static_cast<int>(maps.truth.size())};
    current.T_world_map = Pose(truth[map.first_scan].pose);
    current.points = std::move(exact.finish()->points);
    maps.truth.push_back(std::exchange(current, {}));
  };
  std::vector<std::size_t> taken;
  Pose estimate;
  for (std::size_t i = 0; i < recording->size(); ++i) {
    if (!taken.empty()) {
      const Pose step = truth[taken.back()].pose.inverse() * truth[i].pose;
      if (step.translation.norm() < spacing) continue;
      maps.length += step.translation.norm();
      estimate = estimate * drift.step(step);
    }
    const Points points = points_of(recording->read(i), truth, i);
    current.positions.push_back(truth[i].pose.translation);
    (void)exact.add(points, truth[i].pose);
    taken.push_back(i);
    if (auto map = estimated.add(points, estimate)) {
      map->first_scan = taken[map->first_scan];
      finish(std::move(*map));
    }
  }
  if (auto map = estimated.finish()) {
    map->first_scan = taken[map->first_scan];
    finish(std::move(*map));
  }
  const Pose end = truth[taken.front()].pose.inverse() * truth[taken.back()].pose;
  maps.end_error = (end.translation - estimate.translation).norm();
  return maps;
}

struct Configuration {
  const char* name;
  LoopClosureOptions options;
};

std::vector<Configuration> configurations() {
  std::vector<Configuration> result(5);
  result[0].name = "default";
  result[1].name = "points counted";
  result[1].options.density_image.count = "points";
  result[1].options.density_image.saturation = 0.999;
  result[2].name = "no pruning";
  result[2].options.features.pruning = false;
  result[3].name = "no ground alignment";
  result[3].options.ground_alignment.enabled = false;
  result[4].name = "the paper's";
  LoopClosureOptions& paper = result[4].options;
  paper.density_image.count = "points";
  paper.features.fast_threshold = 35;
  paper.features.max_features = 500;
  paper.features.border_px = 0;
  paper.matching.method = "tree";
  paper.consensus.method = "ransac";
  paper.consensus.orientation_gate_deg = 180.0;
  paper.consensus.guided_bits = 0;
  return result;
}

std::vector<ReportedClosure> detect(const SimulatedMaps& maps, const LoopClosureOptions& options) {
  LoopDatabase database(options);
  std::vector<ReportedClosure> closures;
  for (std::size_t i = 0; i < maps.drifted.size(); ++i) {
    MapDescription description = describe_map(maps.truth[i].key, maps.drifted[i], options);
    for (const ClosureCandidate& candidate : database.query(description)) {
      ReportedClosure closure;
      closure.reference = candidate.reference;
      closure.query = candidate.query;
      closure.inliers = candidate.inliers;
      closure.T_query_reference = closure.initial_T_query_reference = candidate.T_query_reference;
      closures.push_back(closure);
    }
    database.insert(std::move(description));
  }
  return closures;
}

// The figures of a row; those that do not exist are NaN.
std::vector<double> figures(const ClosureEvaluation& e) {
  const auto of = [](const std::optional<double>& v) { return v ? *v : NAN; };
  const DetectionCounts& d = e.detector_accepted;
  const auto found = [&](TravelDirection direction) {
    double all = 0, detected = 0;
    for (const ReferenceClosure& r : e.references) {
      if (r.direction != direction) continue;
      all += 1, detected += r.detected ? 1 : 0;
    }
    return all > 0 ? detected / all : NAN;
  };
  const bool any = e.initial_to_proxy.translation_m.count > 0;
  return {static_cast<double>(e.references.size()),
          of(e.detector.average_precision),
          e.references.empty() ? NAN : e.detector.recall_at_full_precision.value_or(0.0),
          of(e.detector.max_f1),
          static_cast<double>(d.true_positives),
          static_cast<double>(d.misaligned),
          static_cast<double>(d.false_positives),
          static_cast<double>(d.below_overlap),
          any ? e.initial_to_proxy.translation_m.median : NAN,
          any ? e.initial_to_proxy.rotation_deg.median : NAN,
          of(e.overlap_rmse),
          found(TravelDirection::same),
          found(TravelDirection::opposite),
          found(TravelDirection::crossing)};
}

void print_row(const std::string& name, const char* configuration,
               const std::vector<double>& values) {
  std::printf("| %s | %s |", name.c_str(), configuration);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool counted = i == 0 || (4 <= i && i <= 7);
    if (std::isnan(values[i])) {
      std::printf(" - |");
    } else {
      std::printf(!counted                             ? " %.3f |"
                  : values[i] == std::round(values[i]) ? " %.0f |"
                                                       : " %.1f |",
                  values[i]);
    }
  }
  std::printf("\n");
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  double spacing = 2.0, drift = 1.0;
  std::vector<std::string> recordings, only;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--only" && i + 1 < argc) {
      only.emplace_back(argv[++i]);
    } else if ((argument == "--spacing" || argument == "--drift") && i + 1 < argc) {
      (argument == "--spacing" ? spacing : drift) = std::atof(argv[++i]);
    } else {
      recordings.push_back(argument);
    }
  }
  std::printf(
      "| recording | configuration | references | AP | R@1 | F1 | true | misaligned | false | "
      "aligned | "
      "initial m | initial deg | overlap error | found: same | opposite | crossing |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | "
      "--- "
      "|\n");
  std::vector<Configuration> all = configurations();
  std::erase_if(all, [&](const Configuration& c) {
    return !only.empty() && std::find(only.begin(), only.end(), c.name) == only.end();
  });
  std::vector<std::vector<std::vector<double>>> rows(all.size());
  for (const std::string& recording : recordings) {
    const SimulatedMaps maps = build_maps(recording, spacing, drift);
    char name[200];
    std::snprintf(name, sizeof(name), "`%s`, %zu maps, %.0f m, %.1f m off at the end",
                  recording.c_str(), maps.truth.size(), maps.length, maps.end_error);
    for (std::size_t c = 0; c < all.size(); ++c) {
      const auto load = [&](const MapKey& key) {
        return maps.drifted[static_cast<std::size_t>(key.map)];
      };
      const ClosureEvaluation evaluation =
          evaluate_closures(maps.truth, detect(maps, all[c].options), load, {});
      rows[c].push_back(figures(evaluation));
      print_row(name, all[c].name, rows[c].back());
    }
  }
  for (std::size_t c = 0; c < all.size() && recordings.size() > 1; ++c) {
    std::vector<double> mean(rows[c].front().size(), 0.0), count(mean.size(), 0.0);
    for (const std::vector<double>& row : rows[c]) {
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (!std::isnan(row[i])) mean[i] += row[i], count[i] += 1;
      }
    }
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] /= count[i];
    print_row("**mean of " + std::to_string(recordings.size()) + "**", all[c].name, mean);
  }
  return 0;
}

}  // namespace
}  // namespace groundloop

int main(int argc, char** argv) {
  try {
    return groundloop::run(argc, argv);
  } catch (const groundloop::InputError& error) {
    std::fprintf(stderr, "groundloop_detector_table: %s\n", error.what());
    return 2;
  }
}
