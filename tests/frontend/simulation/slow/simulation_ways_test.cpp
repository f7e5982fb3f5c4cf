// The simulated ways: none leads the sensor through a wall, a parked car, a tree or a person.
#include <string>

#include <gtest/gtest.h>

#include "frontend/simulation/simulation.hpp"

namespace groundloop {
namespace {

class SimulatedWay : public ::testing::TestWithParam<const char*> {};

TEST_P(SimulatedWay, ShowsEveryScanASceneWhateverTheSeed) {
  for (const char* seed : {"1", "5", "8"}) {
    const std::string specification = std::string("sim:") + GetParam() + "&seed=" + seed;
    const auto recording = open_simulation(specification + "&sensor=spin16");
    const std::size_t step = recording->parameters().carrier == "car" ? 5 : 12;
    for (std::size_t i = 0; i < recording->size(); i += step) {
      // Of 16384 rays.
      ASSERT_GT(recording->read(i).points.size(), 5000U) << specification << ", scan " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, SimulatedWay,
    ::testing::Values("town?carrier=car&length=400", "town?carrier=walker&length=250",
                      "town?carrier=segway&length=400&change=1", "bridge?carrier=car&length=900",
                      "bridge?carrier=walker&length=600", "park?carrier=car&length=300",
                      "park?carrier=walker&length=200", "park?carrier=segway&length=300"),
    [](const auto& instance) {
      const std::string name = instance.param;
      return name.substr(0, name.find('?')) + "_" +
             name.substr(name.find('=') + 1, name.find('&') - name.find('=') - 1);
    });

}  // namespace
}  // namespace groundloop
