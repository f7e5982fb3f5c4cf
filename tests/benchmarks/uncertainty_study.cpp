// How well uncertainty.csv describes the errors of the maps' poses against the first map:
// normalised squared errors of finished sessions of one recording with ground truth, which are
// chi-square with 6 degrees of freedom where covariances are right. As a Markdown table, a row a
// session and one for all. Usage: groundloop_uncertainty_study SESSION...
#include <cstdio>
#include <string>

#include "apps/config/config.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/graph/relative_pose.hpp"
#include "backend/session/stored_session.hpp"
#include "backend/session/uncertainty_table.hpp"
#include "frontend/core/error.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/simulation/open_any_recording.hpp"

namespace groundloop {
namespace {

// Of chi-square with 6 degrees of freedom, 95 %.
constexpr double kBound = 12.592;

struct Errors {
  int count = 0, inside = 0;
  double sum = 0.0;
  void add(double nees) {
    ++count;
    sum += nees;
    inside += nees < kBound ? 1 : 0;
  }
  void print(const std::string& name) const {
    std::printf("| %s | %d | %.2f | %.2f |\n", name.c_str(), count, sum / 6.0 / count,
                static_cast<double>(inside) / count);
  }
};

Errors errors_of(const std::string& folder) {
  const StoredSession session =
      load_session(folder, apps::effective_config("", {}).slam.loop_closure);
  const SessionPart& part = session.parts.front();
  const Trajectory truth = open_any_recording(part.recording)->ground_truth();
  const TrajectoryEvaluation matched = evaluate_trajectory(part.odometry, truth);
  if (matched.pairs.size() != part.odometry.size())
    throw InputError(folder + ": not every scan has a ground truth");
  std::vector<Pose> T_world_scan(matched.pairs.size());
  for (const auto& [scan, row] : matched.pairs) T_world_scan[scan] = truth[row].pose;
  const std::vector<Matrix6d> covariances =
      read_uncertainty(session.folder.file("uncertainty.csv"));
  Errors errors;
  for (std::size_t m = 1; m < part.maps.size(); ++m) {
    const std::size_t scan = part.maps[m].first_scan;
    const Pose expected = T_world_scan.front().inverse() * T_world_scan[scan];
    const Pose found = part.trajectory.front().pose.inverse() * part.trajectory[scan].pose;
    errors.add(squared_mahalanobis({found.inverse() * expected, covariances[m]}));
  }
  return errors;
}

int run(int count, char** arguments) {
  std::printf("| session | poses | mean of the squared error over 6 | share inside 95 %% |\n");
  std::printf("| --- | --- | --- | --- |\n");
  Errors all;
  for (int i = 1; i < count; ++i) {
    const Errors errors = errors_of(arguments[i]);
    errors.print(SessionFolder(arguments[i]).name());
    all.count += errors.count;
    all.inside += errors.inside;
    all.sum += errors.sum;
  }
  all.print("**all**");
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
