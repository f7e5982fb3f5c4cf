#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/simulation/simulation.hpp"

namespace groundloop {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const std::string& specification) {
  try {
    (void)parse_simulation(specification);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SimulationSpecification, TakesDefaultsForWhatIsNotSaid) {
  const SimulationParameters p = parse_simulation("sim:town");
  EXPECT_EQ(p.world, "town");
  EXPECT_EQ(p.sensor, "spin64");
  EXPECT_EQ(p.carrier, "car");
  EXPECT_EQ(p.length, 1000.0);
  EXPECT_EQ(p.noise, 1.0);
}

TEST(SimulationSpecification, ReadsEveryKey) {
  const SimulationParameters p = parse_simulation(
      "sim:bridge?sensor=spin128&carrier=segway&length=2500.5&seed=7&route=9&change=2&noise=0.5&"
      "fov=290&traffic=2.5");
  EXPECT_EQ(p.world, "bridge");
  EXPECT_EQ(p.sensor, "spin128");
  EXPECT_EQ(p.carrier, "segway");
  EXPECT_EQ(p.length, 2500.5);
  EXPECT_EQ(p.seed, 7U);
  EXPECT_EQ(p.route, 9U);
  EXPECT_EQ(p.change, 2);
  EXPECT_EQ(p.noise, 0.5);
  EXPECT_EQ(p.fov, 290.0);
  EXPECT_EQ(p.traffic, 2.5);
}

TEST(SimulationSpecification, SuggestsTheNearestKeyAndValue) {
  EXPECT_THAT(refusal("sim:town?sead=1"), AllOf(HasSubstr("'sead'"), HasSubstr("'seed'")));
  EXPECT_THAT(refusal("sim:twon"), AllOf(HasSubstr("'twon'"), HasSubstr("'town'")));
  EXPECT_THAT(refusal("sim:town?sensor=spin65"), HasSubstr("'spin64'"));
}

TEST(SimulationSpecification, RefusesWhatIsNotExactlyTheGrammar) {
  for (const char* text :
       {"town", "sim:", "sim:town?", "sim:town?seed", "sim:town?seed=", "sim:town?seed=1&",
        "sim:town?seed=-1", "sim:town?seed=1.5", "sim:town?length=nan", "sim:town?length=0",
        "sim:town?noise=-1", "sim:town?seed=1&seed=1", "sim:town?fov=300",
        "sim:town?sensor=raster&fov=290", "sim:town?change=x", "sim:town?traffic=11"}) {
    EXPECT_NE(refusal(text), "accepted") << text;
  }
}

}  // namespace
}  // namespace groundloop
