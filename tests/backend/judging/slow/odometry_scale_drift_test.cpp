// The scale of odometry's errors over a range of drifts and kinds of false closures.
#include <gtest/gtest.h>

#include "backend/judging/odometry_scale.hpp"
#include "backend/judging/optimizer.hpp"
#include "tests/support/false_closures.hpp"
#include "tests/support/simulated_graph.hpp"

namespace groundloop {
namespace {

constexpr int kLap = 600;

struct Planting {
  const char* name;
  void (*plant)(testing::FalseClosures&, PoseGraph&);
};

const Planting kPlantings[] = {
    {"None", [](testing::FalseClosures&, PoseGraph&) {}},
    {"Random", [](testing::FalseClosures& f, PoseGraph& g) { f.add_random(g, 50, 50); }},
    {"GroupsThatAgree",
     [](testing::FalseClosures& f, PoseGraph& g) { f.add_groups(g, 8, 5, 10, 100); }},
    {"FewMetresOff",
     [](testing::FalseClosures& f, PoseGraph& g) { f.add_near(g, 20, 1, 1, kLap); }},
    {"GroupsFewMetresOff",
     [](testing::FalseClosures& f, PoseGraph& g) { f.add_near(g, 4, 5, 10, kLap); }}};

// Odometry that errs `drift` times as much as it says, 25 true closures, and false ones.
struct Outcome {
  double scale;
  testing::Verdicts verdicts;
  double rmse, clean_rmse;
};

Outcome solve(double drift, const Planting& planting, std::uint64_t seed) {
  const testing::SimulatedGraph simulated = testing::simulate_graph(2400, 25, kLap, seed, drift);
  PoseGraph clean = simulated.graph;
  scale_odometry(clean, drift);
  optimize(clean, {});
  PoseGraph graph = simulated.graph;
  testing::FalseClosures planted(simulated.truth, testing::closure_covariance().inverse(), seed);
  planting.plant(planted, graph);
  const double scale = estimate_odometry_scale(graph).scale;
  scale_odometry(graph, scale);
  OptimizerOptions robust;
  robust.robust = true;
  optimize(graph, robust);
  return {scale, testing::count_verdicts(graph, simulated.graph.edges.size()),
          testing::position_rmse(graph, simulated.truth),
          testing::position_rmse(clean, simulated.truth)};
}

class Drift : public ::testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(Drift, IsFoundAmongFalseClosures) {
  const auto [drift, kind] = GetParam();
  const Outcome outcome = solve(drift, kPlantings[kind], 8);
  // Odometry is not believed to be better than half of what it states.
  EXPECT_GT(outcome.scale, drift / 1.5);
  EXPECT_LT(outcome.scale, std::max(0.51, drift * 1.5));
  EXPECT_LE(outcome.verdicts.true_rejected, 1);
  // Where odometry is lost by 25 m a lap, a group that agrees and is 5 to 20 m off cannot always be
  // told from the true closures around it.
  if (drift == 10.0 && kind == 4) return;
  EXPECT_EQ(outcome.verdicts.false_kept, 0);
  EXPECT_LT(outcome.rmse, 1.05 * outcome.clean_rmse);
}

INSTANTIATE_TEST_SUITE_P(TimesTheStated, Drift,
                         ::testing::Combine(::testing::Values(0.3, 1.0, 3.0, 10.0),
                                            ::testing::Range(0, 5)),
                         [](const auto& parameter) {
                           return std::to_string(
                                      static_cast<int>(std::get<0>(parameter.param) * 10.0)) +
                                  "Tenths" + kPlantings[std::get<1>(parameter.param)].name;
                         });

}  // namespace
}  // namespace groundloop
