#include "backend/mapping/session_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include <spdlog/spdlog.h>

#include "backend/judging/robust.hpp"
#include "backend/mapping/closure_anchor.hpp"
#include "backend/registration/ground_footprint.hpp"

namespace groundloop {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A session while it is solved.
struct Work {
  const SolverInput& given;
  const std::vector<LocalMapRecord>& maps;
  MapStore& store;
  const Trajectory& odometry;              // levelled
  OdometryInformationOptions information;  // scaled
  std::vector<GroundFootprint> footprints;

  [[nodiscard]] ClosureAnchor anchor(int reference, int query,
                                     const Pose& T_query_reference) const {
    return anchor_closure(T_query_reference, maps[reference], given.odometry, maps[query],
                          given.odometry);
  }
};

bool participates(const ClosureRecord& closure) {
  return closure.status == ClosureStatus::accepted || closure.status == ClosureStatus::outlier;
}

// Vertices are map ids. Closures stand between the maps' origins as they are on the levelled
// odometry.
PoseGraph key_pose_graph(const Work& work, const std::vector<ClosureRecord>& closures) {
  const std::vector<LocalMapRecord>& maps = work.maps;
  PoseGraph graph;
  for (const LocalMapRecord& map : maps) {
    graph.vertices.push_back(
        {map.map, work.odometry[map.first_scan].pose, map.map == maps.front().map});
  }
  std::vector<Pose> T_world_scan;
  T_world_scan.reserve(work.odometry.size());
  for (const StampedPose& sample : work.odometry) T_world_scan.push_back(sample.pose);
  for (std::size_t m = 1; m < maps.size(); ++m) {
    const RelativePose step =
        compose_odometry(T_world_scan, maps[m - 1].first_scan, maps[m].first_scan, work.information,
                         work.given.loose);
    Matrix6d information = step.covariance.inverse();
    information = (0.5 * (information + information.transpose())).eval();
    graph.edges.push_back(
        {maps[m - 1].map, maps[m].map, step.T_from_to, information, EdgeKind::odometry});
  }
  for (const ClosureRecord& c : closures) {
    if (!participates(c)) continue;
    const LocalMapRecord &reference = maps[c.reference_map], &query = maps[c.query_map];
    const ClosureAnchor anchor = work.anchor(c.reference_map, c.query_map, c.T_query_reference);
    graph.edges.push_back(
        {c.query_map, c.reference_map,
         carried_to_origins(anchor, reference, work.odometry, query, work.odometry),
         information_between_origins(anchor, c.information, reference, work.odometry, query,
                                     work.odometry, work.given.odometry_information),
         EdgeKind::closure});
  }
  return graph;
}

// Finds how much odometry errs, and calls inconsistent what the pairwise check leaves out.
void find_odometry_scale(Work& work, std::vector<ClosureRecord>& closures,
                         SessionSolution& solution, const Progress& progress) {
  ScaleOptions options;
  options.estimate = work.information.estimate_scale;
  options.pairwise_consistency = work.given.pairwise_consistency;
  options.robust.inlier_probability = work.given.optimizer.inlier_probability;
  OdometryScale found = estimate_odometry_scale(key_pose_graph(work, closures), options, progress);
  solution.odometry_scale = found.scale;
  work.information = scaled(work.information, found.scale);
  if (found.trials.empty()) return;
  std::size_t edge = work.maps.size() - 1;
  const std::vector<std::size_t>& inconsistent = found.trials[found.best].inconsistent;
  for (ClosureRecord& closure : closures) {
    if (!participates(closure)) continue;
    if (std::find(inconsistent.begin(), inconsistent.end(), edge) != inconsistent.end())
      closure.status = ClosureStatus::inconsistent;
    ++edge;
  }
  solution.scale_trials = std::move(found.trials);
}

// Solves the key-pose graph and hands each closure its verdict.
OptimizationSummary judge(const Work& work, std::vector<ClosureRecord>& closures, PoseGraph& graph,
                          const Progress& progress) {
  graph = key_pose_graph(work, closures);
  OptimizationSummary summary = optimize(graph, work.given.optimizer, progress);
  std::size_t edge = work.maps.empty() ? 0 : work.maps.size() - 1;
  for (ClosureRecord& closure : closures) {
    if (!participates(closure)) continue;
    closure.weight = graph.edges[edge].weight;
    closure.status = graph.edges[edge].rejected ? ClosureStatus::outlier : ClosureStatus::accepted;
    ++edge;
  }
  return summary;
}

bool has_closure(const std::vector<ClosureRecord>& closures, int reference, int query) {
  return std::any_of(closures.begin(), closures.end(), [&](const ClosureRecord& c) {
    return c.reference_map == reference && c.query_map == query &&
           c.status == ClosureStatus::accepted;
  });
}

// Tries pairs of maps that overlap in the solution and adds those that hold. Returns how many were
// added.
std::size_t add_revisits(const Work& work, const PoseGraph& graph,
                         std::vector<std::pair<int, int>>& tried,
                         std::vector<ClosureRecord>& closures, SessionSolution& solution,
                         const Progress& progress) {
  constexpr int kSkipped = 3;
  const std::string session = closures.empty() ? std::string() : closures.front().query_session;
  std::size_t added = 0;
  const SolverInput& input = work.given;
  const auto n = static_cast<int>(work.footprints.size());
  for (int query = 0; query < n; ++query) {
    for (int reference = 0; reference + kSkipped < query; ++reference) {
      if (has_closure(closures, reference, query)) continue;
      const Pose T_query_reference =
          graph.vertices[query].pose.inverse() * graph.vertices[reference].pose;
      if (footprint_overlap(work.footprints[reference], work.footprints[query], T_query_reference) <
          input.revisits.min_predicted_overlap) {
        continue;
      }
      const std::pair<int, int> pair(reference, query);
      if (std::find(tried.begin(), tried.end(), pair) != tried.end()) continue;
      tried.push_back(pair);
      ++solution.revisits_tried;
      if (progress) progress("revisits", solution.revisits_tried, 0);
      const std::shared_ptr<StoredMap> q = work.store.get(query), r = work.store.get(reference);
      VerificationOptions limits = input.verification;
      limits.min_agreement = input.revisits.min_agreement;
      const ClosureVerification result = verify_closure(
          q->target(), q->points(), r->points(), T_query_reference, limits, input.registration);
      const Pose moved = T_query_reference.inverse() * result.T_query_reference;
      const bool near =
          moved.translation.norm() <= input.revisits.max_distance &&
          rotation_angle(moved.rotation) <= input.revisits.max_angle_deg * M_PI / 180.0;
      if (result.status != ClosureStatus::accepted || !near ||
          result.overlap < input.revisits.min_overlap)
        continue;
      ClosureRecord record;
      record.reference_session = record.query_session = session;
      record.reference_map = reference;
      record.query_map = query;
      record.source = ClosureSource::overlap;
      record.status = ClosureStatus::accepted;
      record.overlap = result.overlap;
      record.rmse = result.rmse;
      record.agreement = result.agreement;
      record.T_query_reference = result.T_query_reference;
      record.initial_T_query_reference = T_query_reference;
      record.information = result.information;
      closures.push_back(std::move(record));
      ++added;
    }
  }
  return added;
}

// The graph of all scans, started from odometry that is bent to the key poses.
OptimizationSummary solve_all_scans(const Work& work, const std::vector<ClosureRecord>& closures,
                                    const PoseGraph& key_graph, Trajectory& trajectory,
                                    const Progress& progress) {
  const std::vector<LocalMapRecord>& maps = work.maps;
  const Trajectory& odometry = work.odometry;
  PoseGraph graph;
  graph.vertices.reserve(odometry.size());
  graph.edges.reserve(odometry.size() + closures.size());
  for (std::size_t m = 0; m < maps.size(); ++m) {
    // The correction at the map's first scan goes over into that at the next map's.
    const Pose here = key_graph.vertices[m].pose * odometry[maps[m].first_scan].pose.inverse();
    const bool last = m + 1 == maps.size();
    const Pose next =
        last ? here
             : key_graph.vertices[m + 1].pose * odometry[maps[m + 1].first_scan].pose.inverse();
    const auto scans = static_cast<double>(maps[m].last_scan + 1 - maps[m].first_scan);
    for (std::size_t i = maps[m].first_scan; i <= maps[m].last_scan; ++i) {
      const double s = static_cast<double>(i - maps[m].first_scan) / scans;
      const Pose a = here * odometry[i].pose, b = next * odometry[i].pose;
      graph.vertices.push_back({static_cast<int>(i), interpolate(a, b, s), i == 0});
    }
  }
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    const Pose step = odometry[i - 1].pose.inverse() * odometry[i].pose;
    Matrix6d information = odometry_information(step, work.information);
    // Both are diagonal.
    if (!work.given.loose.empty() && !work.given.loose[i].isZero(0.0)) {
      information.diagonal() =
          (information.diagonal().cwiseInverse() + work.given.loose[i]).cwiseInverse();
    }
    graph.edges.push_back(
        {static_cast<int>(i - 1), static_cast<int>(i), step, information, EdgeKind::odometry});
  }
  for (const ClosureRecord& c : closures) {
    if (c.status != ClosureStatus::accepted) continue;
    const ClosureAnchor anchor = work.anchor(c.reference_map, c.query_map, c.T_query_reference);
    // Information of the origins' relative pose, perturbed at the reference's, moved to its scan.
    const Matrix6d carry =
        adjoint(work.given.odometry[maps[c.reference_map].first_scan].pose.inverse() *
                work.given.odometry[anchor.reference_scan].pose);
    graph.edges.push_back({static_cast<int>(anchor.query_scan),
                           static_cast<int>(anchor.reference_scan), anchor.T_query_reference,
                           c.weight * carry.transpose() * c.information * carry,
                           EdgeKind::closure});
  }
  OptimizerOptions options = work.given.optimizer;
  options.robust = false;  // the key-pose graph has judged
  options.initialisation = "guess";
  OptimizationSummary summary = optimize(graph, options, progress);
  trajectory.resize(odometry.size());
  for (std::size_t i = 0; i < odometry.size(); ++i)
    trajectory[i] = {odometry[i].stamp, graph.vertices[i].pose};
  return summary;
}

std::vector<GroundFootprint> footprints_of(const Work& work) {
  std::vector<GroundFootprint> footprints;
  footprints.reserve(work.maps.size());
  for (const LocalMapRecord& map : work.maps)
    footprints.push_back(ground_footprint(work.store.get(map.map)->points()));
  return footprints;
}

// The odometry, upright.
Levelling level(const SolverInput& input, const std::vector<LocalMapRecord>& maps,
                MapStore& store) {
  std::vector<MapVertical> verticals(maps.size());
  if (input.levelling.enabled) {
    for (std::size_t m = 0; m < maps.size(); ++m)
      verticals[m] = find_vertical(store.get(maps[m].map)->points());
  }
  return level_odometry(input.odometry, maps, verticals, input.odometry_information,
                        input.levelling);
}

// Adds closures that the solution reveals, and solves again, until nothing is gained.
void revisit(const Work& work, std::vector<ClosureRecord>& closures, SessionSolution& solution,
             const Progress& progress) {
  std::vector<std::pair<int, int>> tried;
  for (int round = 0; round < work.given.revisits.max_rounds; ++round) {
    auto start = Clock::now();
    const std::size_t added =
        add_revisits(work, solution.key_graph, tried, closures, solution, progress);
    solution.verification_seconds += seconds_since(start);
    if (added == 0) break;
    start = Clock::now();
    solution.key_summary = judge(work, closures, solution.key_graph, progress);
    solution.optimisation_seconds += seconds_since(start);
  }
  solution.revisits_accepted = static_cast<std::size_t>(
      std::count_if(closures.begin(), closures.end(), [](const ClosureRecord& c) {
        return c.source == ClosureSource::overlap && c.status == ClosureStatus::accepted;
      }));
}

// The graph of all scans, and the maps' poses in it.
void finish(const Work& work, const std::vector<ClosureRecord>& closures, SessionSolution& solution,
            const Progress& progress) {
  const auto start = Clock::now();
  solution.summary =
      solve_all_scans(work, closures, solution.key_graph, solution.trajectory, progress);
  solution.T_world_map.clear();
  solution.T_world_map.reserve(work.maps.size());
  for (const LocalMapRecord& map : work.maps)
    solution.T_world_map.push_back(solution.trajectory[map.first_scan].pose);
  solution.optimisation_seconds += seconds_since(start);
}

// Compares with odometry where places were seen twice; a solution that is worse gives up its
// closures, unless asked to stay.
void check_quality(const Work& work, std::vector<ClosureRecord>& closures,
                   SessionSolution& solution, const Progress& progress) {
  const std::vector<LocalMapRecord>& maps = work.maps;
  const auto by_odometry = [&](int reference, int query) {
    return work.given.odometry[maps[query].first_scan].pose.inverse() *
           work.given.odometry[maps[reference].first_scan].pose;
  };
  // The maps are as odometry built them; where they meet, the solution says how they lie.
  const auto solved = [&](int reference, int query) {
    Pose guess = solution.T_world_map[query].inverse() * solution.T_world_map[reference];
    const float reach = work.footprints[reference].radius + work.footprints[query].radius;
    if (guess.translation.norm() > static_cast<double>(reach)) return guess;
    ClosureAnchor anchor = work.anchor(reference, query, guess);
    anchor.T_query_reference = solution.trajectory[anchor.query_scan].pose.inverse() *
                               solution.trajectory[anchor.reference_scan].pose;
    return carried_to_origins(anchor, maps[reference], work.given.odometry, maps[query],
                              work.given.odometry);
  };
  solution.map_quality =
      compare_revisits(work.footprints, by_odometry, solved, work.store, work.given.map_quality);
  MapQuality& quality = solution.map_quality;
  if (!quality.worse) return;
  quality.given_up = !work.given.map_quality.keep_worse;
  spdlog::warn(
      "the map at revisits is worse after closing loops: surfaces {:.3f} m apart, {:.3f} m by "
      "odometry; {}",
      quality.after.plane_thickness, quality.before.plane_thickness,
      quality.given_up ? "the closures are given up and the trajectory is the odometry"
                       : "kept all the same, as map_quality.keep_worse asks");
  if (!quality.given_up) return;
  for (ClosureRecord& c : closures) {
    if (c.status == ClosureStatus::accepted) c.status = ClosureStatus::outlier;
    c.weight = 0.0;
  }
  std::vector<ClosureRecord> none;
  solution.revisits_accepted = 0;
  solution.key_summary = judge(work, none, solution.key_graph, progress);
  finish(work, none, solution, progress);
}

}  // namespace

SessionSolution solve_session(const SolverInput& given, const std::vector<LocalMapRecord>& maps,
                              MapStore& store, std::vector<ClosureRecord>& closures,
                              const Progress& progress) {
  SessionSolution solution;
  auto start = Clock::now();
  solution.levelling = level(given, maps, store);
  solution.levelling_seconds = seconds_since(start);
  start = Clock::now();
  Work work{given, maps, store, solution.levelling.odometry, given.odometry_information, {}};
  if (given.optimizer.robust) find_odometry_scale(work, closures, solution, progress);
  solution.key_summary = judge(work, closures, solution.key_graph, progress);
  solution.optimisation_seconds += seconds_since(start);
  const bool connected = std::any_of(closures.begin(), closures.end(), [](const ClosureRecord& c) {
    return c.status == ClosureStatus::accepted;
  });
  if (connected && (given.revisits.enabled || given.map_quality.pairs > 0)) {
    start = Clock::now();
    work.footprints = footprints_of(work);
    solution.verification_seconds += seconds_since(start);
  }
  if (connected && given.revisits.enabled) revisit(work, closures, solution, progress);
  finish(work, closures, solution, progress);
  if (connected && given.map_quality.pairs > 0) check_quality(work, closures, solution, progress);
  return solution;
}

}  // namespace groundloop
