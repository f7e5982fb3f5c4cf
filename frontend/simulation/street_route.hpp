// The carrier's way through the street network: a walk over crossings that comes back along its own
// streets in the same and in the opposite direction, turned into a smooth line in the right-hand
// lane.
#pragma once

#include <vector>

#include "frontend/simulation/street_network.hpp"
#include "frontend/simulation/world.hpp"

namespace groundloop::simulation {

/// Crossings in the order they are passed; long enough for the asked length. All routes of one
/// world and length keep to the same few streets, so that two of them overlap.
[[nodiscard]] std::vector<Crossing> choose_crossings(const StreetNetwork& network,
                                                     const SimulationParameters& parameters);

[[nodiscard]] Way plan_street_route(const StreetNetwork& network,
                                    const SimulationParameters& parameters);

}  // namespace groundloop::simulation
