// Runs the back end alone on a finished session, as often as asked, and measures it against ground
// truth: the table of absolute pose errors without closures, with the detector's own, with robust
// solving, with everything (tests/benchmarks/ape_table.sh), and the normalised squared error of the
// closures. Usage: groundloop_back_end_study SESSION [--truth TUM] [--candidates] [KEY=VALUE]...
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "apps/config/config.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/judging/odometry_scale.hpp"
#include "backend/mapping/closure_anchor.hpp"
#include "backend/mapping/session_solver.hpp"
#include "backend/session/stored_session.hpp"
#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace {

struct Study {
  SessionFolder folder;
  SessionPart part;
  Trajectory truth;
  apps::Config config;
  std::vector<Pose> true_scan;  // T_world_scan of each scan, empty without truth

  std::vector<ClosureRecord> closures(MapStore& store, bool verify) {
    LoopDatabase database(config.slam.loop_closure);
    std::vector<ClosureRecord> records;
    ClosureOptions options = config.slam.closures;
    options.verification = verify;
    for (const MapDescription& description : part.descriptions) {
      for (const ClosureCandidate& candidate : database.query(description)) {
        records.push_back(verify_candidate(candidate, store, candidate.query.map, store,
                                           candidate.reference.map, options,
                                           config.slam.verification, config.slam.registration));
      }
      database.insert(description);
    }
    return records;
  }

  // Translation, rotation and normalised squared error of a closure.
  void errors(const ClosureRecord& c, double& m, double& deg, double& nees) const {
    m = deg = nees = std::nan("");
    if (true_scan.empty()) return;
    // At the scans that met, where the final graph has it.
    const LocalMapRecord& reference = part.maps[c.reference_map];
    const LocalMapRecord& query = part.maps[c.query_map];
    const ClosureAnchor anchor =
        anchor_closure(c.T_query_reference, reference, part.odometry, query, part.odometry);
    const Pose expected = true_scan[anchor.query_scan].inverse() * true_scan[anchor.reference_scan];
    const Pose error = anchor.T_query_reference.inverse() * expected;
    m = error.translation.norm();
    deg = rotation_angle(error.rotation) * 180.0 / M_PI;
    const Matrix6d carry = adjoint(part.odometry[reference.first_scan].pose.inverse() *
                                   part.odometry[anchor.reference_scan].pose);
    const Vector6d xi = carry * log_se3(error);
    nees = xi.dot(c.information * xi);
  }

  // One row of the table.
  void solve(const char* name, std::vector<ClosureRecord> records, MapStore& store, bool robust,
             bool revisits, bool list, bool level = true) {
    OptimizerOptions optimizer = config.slam.pose_graph;
    optimizer.robust = robust;
    RevisitOptions more = config.slam.revisits;
    more.enabled = revisits;
    OdometryInformationOptions drift = config.slam.odometry_information;
    drift.estimate_scale = drift.estimate_scale && robust;
    LevellingOptions levelling = config.slam.levelling;
    levelling.enabled = levelling.enabled && level;
    const SolverInput input{part.odometry,
                            levelling,
                            drift,
                            optimizer,
                            more,
                            config.slam.map_quality,
                            config.slam.verification,
                            config.slam.registration,
                            robust && config.slam.closures.pairwise_consistency};
    const SessionSolution solution = solve_session(input, part.maps, store, records, {});
    int accepted = 0, wrong = 0, counted = 0;
    double sum = 0.0;
    std::vector<double> all;
    for (const ClosureRecord& c : records) {
      double m, deg, nees;
      errors(c, m, deg, nees);
      if (list && c.status != ClosureStatus::few_inliers) {
        std::printf(
            "  %3d %3d %-8s %4d inliers overlap %.2f agreement %5.2f rmse %.3f %-12s error %7.2f m "
            "%6.2f deg nees %9.1f\n",
            c.reference_map, c.query_map, to_string(c.source), c.inliers, c.overlap.value_or(0),
            c.agreement.value_or(0), c.rmse.value_or(0), to_string(c.status), m, deg, nees);
      }
      if (c.status != ClosureStatus::accepted) continue;
      ++accepted;
      if (m > 5.0 || deg > 5.0) ++wrong;
      sum += nees;
      all.push_back(nees);
      ++counted;
    }
    const double ape = truth.empty()
                           ? std::nan("")
                           : evaluate_trajectory(solution.trajectory, truth).ape.translation_m.rmse;
    std::printf("| %s | %d | %d | %.3f | %.2f | %.1f | %.1f |\n", name, accepted, wrong, ape,
                solution.odometry_scale, counted > 0 ? sum / counted : 0.0, statistics(all).median);
    if (list) {
      const Levelling& l = solution.levelling;
      std::printf(
          "  levelled by %zu maps: bend %.2e +- %.1e rad/m, walk %.2f of the stated, scatter %.2f "
          "deg; %.2f s\n",
          l.maps, l.bend, l.bend_deviation, l.walk_scale, l.scatter * 180.0 / M_PI,
          solution.levelling_seconds);
      if (!truth.empty()) {
        const TrajectoryEvaluation e = evaluate_trajectory(solution.trajectory, truth);
        const TrajectoryEvaluation o = evaluate_trajectory(l.odometry, truth);
        std::printf("  along x y z: %.3f %.3f %.3f m; levelled odometry %.3f m (%.3f %.3f %.3f)\n",
                    e.ape_x_m.rmse, e.ape_y_m.rmse, e.ape_z_m.rmse, o.ape.translation_m.rmse,
                    o.ape_x_m.rmse, o.ape_y_m.rmse, o.ape_z_m.rmse);
      }
      const MapQuality& quality = solution.map_quality;
      std::printf("  %zu revisits: %.3f m apart by odometry, %.3f m in the solution; %.2f s%s\n",
                  quality.pairs, quality.before.plane_thickness, quality.after.plane_thickness,
                  quality.seconds, quality.worse ? ", WORSE" : "");
      for (const ScaleTrial& t : solution.scale_trials)
        std::printf("  scale %5.2f accepts %d log evidence %.2f\n", t.scale, t.accepted,
                    t.log_evidence);
    }
  }
};

int run(int count, char** arguments) {
  std::string folder, truth;
  std::vector<std::string> settings;
  bool list = false;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--truth" && i + 1 < count) {
      truth = arguments[++i];
    } else if (argument == "--candidates") {
      list = true;
    } else if (argument.find('=') != std::string::npos) {
      settings.push_back(argument);
    } else {
      folder = argument;
    }
  }
  const apps::Config config = apps::effective_config("", settings);
  StoredSession session = load_session(folder, config.slam.loop_closure);
  Study study{session.folder, session.parts.front(), {}, config, {}};
  study.truth =
      truth.empty() ? open_any_recording(study.part.recording)->ground_truth() : read_tum(truth);
  if (!study.truth.empty()) {
    const TrajectoryEvaluation e = evaluate_trajectory(study.part.odometry, study.truth);
    if (e.pairs.size() != study.part.odometry.size()) {
      throw InputError(folder + ": " + std::to_string(e.pairs.size()) + " of " +
                       std::to_string(study.part.odometry.size()) +
                       " scans have a ground truth; make the session again from this recording");
    }
    study.true_scan.resize(e.pairs.size());
    for (const auto& [scan, row] : e.pairs) study.true_scan[scan] = study.truth[row].pose;
    std::printf("%s: %zu scans, %.0f m, drift %.2f %%\n", study.part.recording.c_str(),
                study.true_scan.size(), e.path_length_m, e.kitti_translation_percent);
  }
  MapStore store(study.folder, config.slam.registration, 40);
  std::printf(
      "| variant | closures | false | APE, m | odometry scale | mean NEES | median NEES |\n| --- | "
      "--- | --- | --- | --- | --- | --- |\n");
  study.solve("odometry", {}, store, false, false, false, false);
  study.solve("odometry, levelled", {}, store, false, false, false);
  study.solve("detector only", study.closures(store, false), store, false, false, false);
  const std::vector<ClosureRecord> verified = study.closures(store, true);
  std::vector<ClosureRecord> unverified = study.closures(store, false);
  study.solve("detector and robust", unverified, store, true, false, false);
  study.solve("verified, not robust", verified, store, false, false, false);
  study.solve("verified and robust", verified, store, true, false, list);
  study.solve("all, not levelled", verified, store, true, true, false, false);
  study.solve("all", verified, store, true, true, list);
  const PlantedClosureOptions& planted = config.slam.planted_closures;
  if (planted.random + planted.groups + planted.near > 0) {
    std::vector<ClosureRecord> closures = verified;
    plant_false_closures(planted, study.part.odometry, study.part.maps, closures);
    const std::string name =
        "all, " + std::to_string(closures.size() - verified.size()) + " false ones planted";
    study.solve(name.c_str(), closures, store, true, true, list);
  }
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
