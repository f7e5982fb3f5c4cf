// Specifications of simulated recordings; the longest worlds are not built here.
#include "frontend/simulation/simulation.hpp"

#include "tests/fuzz/fuzz_target.hpp"

GROUNDLOOP_FUZZ_TARGET(simulation) {
  const SimulationParameters parameters = parse_simulation("sim:" + std::string(text_of(input)));
  FUZZ_PROMISE(parameters.length >= 10.0 && parameters.length <= 1e5);
  FUZZ_PROMISE(parameters.noise >= 0.0);
}
