// False closures planted among those of a finished session leave the solution what it was.
#include "tests/support/planted_closures.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "apps/config/config.hpp"
#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/mapping/closure_finder.hpp"
#include "backend/mapping/session_solver.hpp"
#include "backend/session/stored_session.hpp"
#include "loopclosure/loop_database.hpp"
#include "tests/support/command.hpp"
#include "tests/support/real_drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::run_command;
using testing::TemporaryFolder;

// A session of one recording, to be solved again as the run solved it.
class Solver {
 public:
  explicit Solver(const std::filesystem::path& folder)
      : options_(apps::effective_config("", {}).slam),
        session_(load_session(folder, options_.loop_closure)),
        store_(session_.folder, options_.registration, 40) {}

  [[nodiscard]] const SessionPart& part() const { return session_.parts.front(); }

  // The detector's candidates, verified and not judged.
  [[nodiscard]] std::vector<ClosureRecord> verified() {
    LoopDatabase database(options_.loop_closure);
    std::vector<ClosureRecord> records;
    for (const MapDescription& description : part().descriptions) {
      for (const ClosureCandidate& candidate : database.query(description)) {
        records.push_back(verify_candidate(candidate, store_, candidate.query.map, store_,
                                           candidate.reference.map, options_.closures,
                                           options_.verification, options_.registration));
      }
      database.insert(description);
    }
    return records;
  }

  [[nodiscard]] Trajectory solve(std::vector<ClosureRecord>& closures) {
    const SolverInput input{
        part().odometry,       options_.levelling,    options_.odometry_information,
        options_.pose_graph,   options_.revisits,     options_.map_quality,
        options_.verification, options_.registration, options_.closures.pairwise_consistency};
    return solve_session(input, part().maps, store_, closures, {}).trajectory;
  }

 private:
  SlamOptions options_;
  StoredSession session_;
  MapStore store_;
};

double apart(const Trajectory& a, const Trajectory& b) {
  return evaluate_trajectory(a, b).ape.translation_m.rmse;
}

// Solves the session of `recording` as it is, and with random false closures, a group that agrees,
// and near ones.
void compare(const std::string& recording) {
  const TemporaryFolder folder;
  const auto result = run_command(
      {"run", recording, "--out", (folder / "session").string(), "--set", "map.write=false"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  Solver solver(folder / "session");
  const std::vector<ClosureRecord> verified = solver.verified();
  std::vector<ClosureRecord> closures = verified;
  const Trajectory clean = solver.solve(closures);
  // What is solved here is what the run solved; its files have micrometres.
  EXPECT_LT(apart(clean, solver.part().trajectory), 1e-3);
  EXPECT_TRUE(std::any_of(closures.begin(), closures.end(), [](const ClosureRecord& c) {
    return c.status == ClosureStatus::accepted;
  }));

  closures = verified;
  testing::PlantedClosures planted;
  planted.random = 8;
  planted.groups = 1;
  planted.near = 3;
  testing::plant_false_closures(planted, solver.part().odometry, solver.part().maps, closures);
  const std::size_t with_planted = closures.size();
  ASSERT_GE(with_planted, verified.size() + 8 + 3);
  const Trajectory held = solver.solve(closures);
  for (std::size_t i = verified.size(); i < with_planted; ++i)
    EXPECT_NE(closures[i].status, ClosureStatus::accepted)
        << closures[i].reference_map << " - " << closures[i].query_map;
  EXPECT_LT(apart(held, clean), 0.1);
}

TEST(PlantedClosures, LeaveATownWhatItWas) { compare("sim:town?sensor=spin16&length=1000&seed=3"); }

TEST(PlantedClosures, LeaveTheRealDriveWhatItWas) {
  const std::filesystem::path drive = testing::real_drive();
  if (drive.empty())
    GTEST_SKIP() << "the real drive (kitti_00_keyframes) is not beside the project";
  compare(drive.string());
}

}  // namespace
}  // namespace groundloop
