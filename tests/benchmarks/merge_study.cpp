// Looks into the closures between two finished sessions: every candidate with its error against
// ground truth at the maps' origins, what registration makes of it from the truth, and how pairs of
// the verified ones agree over both odometries as stated.
// Usage: groundloop_merge_study REFERENCE QUERY [KEY=VALUE]...
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "apps/config/config.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/graph/graph_chains.hpp"
#include "backend/judging/pairwise_consistency.hpp"
#include "backend/merging/session_matching.hpp"
#include "backend/registration/ground_footprint.hpp"
#include "backend/session/map_store.hpp"
#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop {
namespace {

constexpr double kDegrees = 180.0 / M_PI;

struct Side {
  StoredSession session;
  std::vector<Pose> T_world_map;  // ground truth
  std::unique_ptr<MapStore> store;

  [[nodiscard]] const SessionPart& part() const { return session.parts.front(); }
};

Side load(const std::string& folder, const apps::Config& config) {
  Side side{load_session(folder, config.slam.loop_closure), {}, nullptr};
  const Trajectory truth = open_any_recording(side.part().recording)->ground_truth();
  if (truth.empty()) throw InputError(folder + ": its recording has no ground truth");
  const TrajectoryEvaluation odometry = evaluate_trajectory(side.part().odometry, truth);
  std::vector<Pose> by_scan(side.part().odometry.size());
  for (const auto& [scan, row] : odometry.pairs) by_scan[scan] = truth[row].pose;
  for (const LocalMapRecord& map : side.part().maps)
    side.T_world_map.push_back(by_scan[map.first_scan]);
  side.store = std::make_unique<MapStore>(side.session.folder, config.slam.registration, 40);
  std::printf("%s: %s, %.0f m, drift %.2f %%, from scan to scan %.3f m and %.3f deg rms\n",
              side.part().name.c_str(), side.part().recording.c_str(), odometry.path_length_m,
              odometry.kitti_translation_percent, odometry.rpe_frame.translation_m.rmse,
              odometry.rpe_frame.rotation_deg.rmse);
  return side;
}

struct Error {
  double metres, degrees, nees;
};

Error error_of(const Pose& found, const Pose& expected, const Matrix6d& information) {
  const Pose error = found.inverse() * expected;
  const Vector6d xi = log_se3(error);
  return {error.translation.norm(), rotation_angle(error.rotation) * kDegrees,
          xi.dot(information * xi)};
}

void print_candidate(const ClosureRecord& c, Side& reference, Side& query,
                     const apps::Config& config) {
  const Pose expected =
      query.T_world_map[c.query_map].inverse() * reference.T_world_map[c.reference_map];
  const Error error = error_of(c.T_query_reference, expected, c.information);
  const Error initial = error_of(c.initial_T_query_reference, expected, c.information);
  const auto q = query.store->get(c.query_map);
  const auto r = reference.store->get(c.reference_map);
  const double shared =
      footprint_overlap(ground_footprint(r->points()), ground_footprint(q->points()), expected);
  std::printf(
      "%3d %3d %4d inliers %-12s overlap %.2f agreement %5.2f rmse %.3f detector %7.2f m "
      "%6.2f deg refined %7.2f m %6.2f deg nees %8.1f shared ground %.2f",
      c.reference_map, c.query_map, c.inliers, to_string(c.status), c.overlap.value_or(0),
      c.agreement.value_or(0), c.rmse.value_or(0), initial.metres, initial.degrees, error.metres,
      error.degrees, error.nees, shared);
  if (shared > 0.0) {
    const ClosureVerification best =
        verify_closure(q->target(), q->points(), r->points(), expected, config.slam.verification,
                       config.slam.registration);
    const Error from_truth = error_of(best.T_query_reference, expected, best.information);
    std::printf(" | from the truth: %-12s overlap %.2f agreement %5.2f moved %.2f m %.2f deg",
                to_string(best.status), best.overlap, best.agreement, from_truth.metres,
                from_truth.degrees);
  }
  std::printf("\n");
}

// Pairs of maps that share ground: what verification says of them from the truth.
void print_pairs(Side& reference, Side& query, const apps::Config& config) {
  std::printf("pairs that share a fifth of the ground, verified from the truth\n");
  VerificationOptions limits = config.slam.verification;
  limits.min_agreement = config.slam.revisits.min_agreement;
  limits.between_sessions = true;
  for (const LocalMapRecord& qm : query.part().maps) {
    const auto q = query.store->get(qm.map);
    const GroundFootprint footprint = ground_footprint(q->points());
    for (const LocalMapRecord& rm : reference.part().maps) {
      const Pose T = query.T_world_map[qm.map].inverse() * reference.T_world_map[rm.map];
      if (T.translation.norm() > 200.0) continue;
      const auto r = reference.store->get(rm.map);
      const double shared = footprint_overlap(ground_footprint(r->points()), footprint, T);
      if (shared < 0.2) continue;
      const ClosureVerification v = verify_closure(q->target(), q->points(), r->points(), T, limits,

                                                   config.slam.registration);
      const Error e = error_of(v.T_query_reference, T, v.information);
      std::printf(
          "%3d %3d ground %.2f turned %4.0f deg %-12s overlap %.2f agreement %5.2f moved "
          "%.2f m %.2f deg nees %.1f contrast %.2f\n",
          rm.map, qm.map, shared, rotation_angle(T.rotation) * kDegrees, to_string(v.status),
          v.overlap, v.agreement, e.metres, e.degrees, e.nees, v.contrast.value_or(0.0));
    }
  }
}

void print_agreement(const std::vector<ClosureRecord>& verified, const Side& reference,
                     const Side& query) {
  std::vector<int> in_reference, in_query;
  std::vector<PairwiseClosure> closures;
  for (const ClosureRecord& c : verified) {
    in_reference.push_back(c.reference_map);
    in_query.push_back(c.query_map);
    closures.push_back(
        {c.query_map, c.reference_map, {c.T_query_reference, c.information.inverse()}});
  }
  const GraphChains r(reference.session.graph, in_reference);
  const GraphChains q(query.session.graph, in_query);
  const auto chain = [](const GraphChains& chains) {
    return [&chains](int from, int to) { return chains.between(from, to); };
  };
  std::printf("squared distances of pairs (16.8 is the bound)\n");
  for (std::size_t i = 0; i < closures.size(); ++i) {
    std::printf("%3d %3d:", closures[i].to, closures[i].from);
    for (std::size_t j = 0; j < closures.size(); ++j)
      std::printf(" %7.1f", pairwise_distance(closures[i], closures[j], chain(q), chain(r)));
    std::printf("\n");
  }
}

int run(int count, char** arguments) {
  std::vector<std::string> folders, settings;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    (argument.find('=') != std::string::npos ? settings : folders).push_back(argument);
  }
  if (folders.size() != 2) throw InputError("usage: groundloop_merge_study REFERENCE QUERY");
  const apps::Config config = apps::effective_config("", settings);
  Side reference = load(folders[0], config);
  Side query = load(folders[1], config);
  const SlamOptions& slam = config.slam;
  const PairMatches matches =
      match_parts(reference.part(), *reference.store, query.part(), *query.store,
                  {slam.loop_closure, slam.closures, slam.verification, slam.registration});
  std::vector<ClosureRecord> verified;
  for (const ClosureRecord& c : matches.closures) {
    print_candidate(c, reference, query, config);
    if (c.status == ClosureStatus::accepted) verified.push_back(c);
  }
  print_agreement(verified, reference, query);
  print_pairs(reference, query, config);
  return 0;
}

}  // namespace
}  // namespace groundloop

int main(int count, char** arguments) {
  try {
    return groundloop::run(count, arguments);
  } catch (const groundloop::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
