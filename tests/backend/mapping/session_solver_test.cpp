// The solution of a session whose answer is known: odometry along a straight line, and closures
// that say how much longer or shorter it is.
#include "backend/mapping/session_solver.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "frontend/core/pcd.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

constexpr int kMaps = 7;
constexpr std::size_t kScansOfAMap = 10;
constexpr double kStep = 12.0;  // m; farther apart than scans of one meeting
constexpr double kClosureInformation = 1e4;

class SessionSolver : public ::testing::Test {
 protected:
  SessionSolver() {
    std::filesystem::create_directories(folder_ / "local_maps");
    for (std::size_t i = 0; i < kMaps * kScansOfAMap; ++i)
      odometry_.push_back({static_cast<std::int64_t>(i) * 100000000, at(i)});
    for (int m = 0; m < kMaps; ++m) {
      const std::size_t first = static_cast<std::size_t>(m) * kScansOfAMap;
      maps_.push_back({m, first, first + kScansOfAMap - 1, 1, odometry_[first].pose});
      write_pcd(SessionFolder(folder_.path()).local_map(m), {{0.0F, 0.0F, 0.0F}});
    }
  }

  static Pose at(std::size_t scan) {
    Pose pose;
    pose.translation.x() = kStep * static_cast<double>(scan);
    return pose;
  }

  // Between the first map and another, that says it lies `off` metres further along the line.
  ClosureRecord closure(int query, double off) const {
    ClosureRecord c;
    c.reference_map = 0;
    c.query_map = query;
    c.status = ClosureStatus::accepted;
    c.T_query_reference =
        maps_[static_cast<std::size_t>(query)].T_world_map.inverse() * maps_[0].T_world_map;
    c.T_query_reference.translation.x() -= off;
    c.initial_T_query_reference = c.T_query_reference;
    c.information = kClosureInformation * Matrix6d::Identity();
    return c;
  }

  SessionSolution solve(std::vector<ClosureRecord>& closures, bool robust) {
    SolverInput input{odometry_, {}, {}, {}, {}, {}, {}, {}};
    input.levelling.enabled = false;
    input.revisits.enabled = false;
    input.map_quality.pairs = 0;
    input.optimizer.robust = robust;
    input.optimizer.function_tolerance = 1e-14;
    MapStore store(SessionFolder(folder_.path()), {});
    return solve_session(input, maps_, store, closures, {});
  }

  testing::TemporaryFolder folder_;
  Trajectory odometry_;
  std::vector<LocalMapRecord> maps_;
};

TEST_F(SessionSolver, WithoutClosuresIsTheOdometry) {
  std::vector<ClosureRecord> none;
  const SessionSolution solution = solve(none, true);
  ASSERT_EQ(solution.trajectory.size(), odometry_.size());
  for (std::size_t i = 0; i < odometry_.size(); ++i) {
    EXPECT_LT((solution.trajectory[i].pose.translation - odometry_[i].pose.translation).norm(),
              1e-9);
    EXPECT_EQ(solution.trajectory[i].stamp, odometry_[i].stamp);
  }
  EXPECT_EQ(solution.odometry_scale, 1.0);
}

// The maps meet at the last scan of the first and the first scan of the last: the steps between
// share the correction, springs in series with the closure's own.
TEST_F(SessionSolver, SpreadsAClosureOverTheScansBetweenThoseThatMet) {
  constexpr double kOff = -0.5;
  std::vector<ClosureRecord> closures = {closure(kMaps - 1, kOff)};
  const SessionSolution solution = solve(closures, false);
  const std::size_t a = maps_.front().last_scan, b = maps_.back().first_scan;
  const double step_variance = odometry_covariance(at(1), {})(0, 0);
  const double chain = static_cast<double>(b - a) * step_variance;
  const double moved = kOff * chain / (chain + 1.0 / kClosureInformation);
  for (std::size_t i = 0; i < odometry_.size(); ++i) {
    const double share = i <= a   ? 0.0
                         : i >= b ? 1.0
                                  : static_cast<double>(i - a) / static_cast<double>(b - a);
    const Eigen::Vector3d expected = at(i).translation + Eigen::Vector3d(share * moved, 0.0, 0.0);
    EXPECT_LT((solution.trajectory[i].pose.translation - expected).norm(), 1e-5) << "scan " << i;
    EXPECT_LT(rotation_angle(solution.trajectory[i].pose.rotation), 1e-6) << "scan " << i;
  }
  for (std::size_t m = 0; m < maps_.size(); ++m)
    EXPECT_EQ(solution.T_world_map[m].translation,
              solution.trajectory[maps_[m].first_scan].pose.translation);
}

TEST_F(SessionSolver, LeavesOutTheClosureThatTheOthersContradict) {
  std::vector<ClosureRecord> closures = {closure(kMaps - 1, 0.05), closure(kMaps - 2, 0.04),
                                         closure(kMaps - 3, 15.0), closure(kMaps - 3, 0.03)};
  const SessionSolution solution = solve(closures, true);
  EXPECT_EQ(closures[0].status, ClosureStatus::accepted);
  EXPECT_EQ(closures[1].status, ClosureStatus::accepted);
  EXPECT_NE(closures[2].status, ClosureStatus::accepted);
  EXPECT_EQ(closures[3].status, ClosureStatus::accepted);
  for (std::size_t i = 0; i < odometry_.size(); ++i) {
    EXPECT_LT((solution.trajectory[i].pose.translation - at(i).translation).norm(), 0.06)
        << "scan " << i;
  }
  // The graph names only what it stands on.
  const auto closing = std::count_if(
      solution.key_graph.edges.begin(), solution.key_graph.edges.end(),
      [](const GraphEdge& edge) { return edge.kind == EdgeKind::closure && !edge.rejected; });
  EXPECT_EQ(closing, 3);
}

}  // namespace
}  // namespace groundloop
