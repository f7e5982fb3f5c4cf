// sphere2500 with false closures among the true ones (Yang et al., RA-L 2020, use it so).
#include <cstdio>
#include <filesystem>

#include <gtest/gtest.h>

#include "backend/graph/g2o_file.hpp"
#include "backend/judging/optimizer.hpp"
#include "tests/support/false_closures.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

class Sphere2500 : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const auto file = std::filesystem::path(GROUNDLOOP_SHARED_DATA) / "pose_graphs/sphere2500.g2o";
    if (!std::filesystem::exists(file)) {
      GTEST_SKIP() << "needs the public pose graph " << file.string();
    }
    graph_ = read_g2o(file).graph;
    PoseGraph clean = graph_;
    optimize(clean, {});
    for (const GraphVertex& vertex : clean.vertices) clean_.push_back(vertex.pose);
    for (const GraphEdge& edge : graph_.edges) {
      if (edge.kind != EdgeKind::closure) continue;
      ++true_closures_;
      information_ = edge.information;
    }
  }

  void solve_and_check(const char* kind) {
    const std::size_t first_false = first_false_;
    OptimizerOptions options;
    options.robust = true;
    const OptimizationSummary summary = optimize(graph_, options);
    const testing::Verdicts verdicts = testing::count_verdicts(graph_, first_false);
    const double rmse = testing::position_rmse(graph_, clean_);
    std::printf(
        "%s, %d %%: rmse to the clean solution %.4f m, precision %.4f, recall %.4f, %.1f s\n", kind,
        GetParam(), rmse, verdicts.precision(), verdicts.recall(), summary.seconds.total);
    // The sphere has a radius of 50 m: 0.5 m is a hundredth of it.
    EXPECT_LT(rmse, 0.5);
    EXPECT_GT(verdicts.recall(), 0.99);
    EXPECT_GT(verdicts.precision(), 0.95);
  }

  PoseGraph graph_;
  std::vector<Pose> clean_;
  Matrix6d information_;
  int true_closures_ = 0;
  std::size_t first_false_ = 0;
};

TEST_P(Sphere2500, RandomFalseClosuresLeaveTheCleanSolution) {
  first_false_ = graph_.edges.size();
  testing::FalseClosures(clean_, information_, 1)
      .add_random(graph_, true_closures_ * GetParam() / 100, 2);
  solve_and_check("random");
}

class Sphere2500Groups : public Sphere2500 {};

TEST_P(Sphere2500Groups, GroupsOfFalseClosuresLeaveTheCleanSolution) {
  first_false_ = graph_.edges.size();
  testing::FalseClosures(clean_, information_, 1)
      .add_groups(graph_, true_closures_ * GetParam() / 500, 5, 1, 50);
  solve_and_check("groups of 5");
}

INSTANTIATE_TEST_SUITE_P(Percent, Sphere2500, ::testing::Values(10, 30, 60, 90));
// One of them: each takes minutes of a loaded machine.
INSTANTIATE_TEST_SUITE_P(Percent, Sphere2500Groups, ::testing::Values(30));

}  // namespace
}  // namespace groundloop
