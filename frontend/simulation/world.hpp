// What the simulated worlds have in common: a ground, chunks of scenery that are built when the
// sensor comes near, and a way for the carrier. Everything is a function of the seeds, so that a
// chunk is the same whenever it is built, and memory does not grow with the way's length.
#pragma once

#include <memory>
#include <vector>

#include "frontend/simulation/mesh.hpp"
#include "frontend/simulation/simulation.hpp"

namespace groundloop::simulation {

/// A square of the world, of side World::chunk_size, centred at (i, j) * chunk_size.
struct ChunkId {
  int i = 0, j = 0;
  auto operator<=>(const ChunkId&) const = default;
};

/// The line that the carrier follows, with what traffic needs to know of the street it lies in.
struct Way {
  std::vector<Vec2> points;        ///< about half a metre apart
  std::vector<double> along;       ///< lateral offset (left positive) of cars of its direction, m
  std::vector<double> oncoming;    ///< the same of cars that come the other way, m
  std::vector<double> pavement;    ///< distance from the street's centre to where people walk, m
  std::vector<double> centre;      ///< lateral offset of the street's centre line, m
  std::vector<std::size_t> stops;  ///< points where the carrier may have to wait
  bool cars = true;                ///< whether there is traffic beside people
};

class World {
 public:
  virtual ~World() = default;
  /// Height of the ground that carriers move on (a bridge's deck over its river), metres.
  [[nodiscard]] virtual double ground(const Vec2& p) const = 0;
  [[nodiscard]] virtual double chunk_size() const = 0;
  /// How far scenery of a chunk may reach beyond its square, metres.
  [[nodiscard]] virtual double overhang() const = 0;
  /// Scenery and terrain of a chunk; the mesh's origin is set by the caller.
  virtual void build(const ChunkId& chunk, Mesh& mesh) const = 0;
  [[nodiscard]] virtual Way plan(const SimulationParameters& parameters) const = 0;
};

[[nodiscard]] std::unique_ptr<World> make_world(const SimulationParameters& parameters);
/// With a river, the bridge world: two quarters of different build, and one bridge.
[[nodiscard]] std::unique_ptr<World> make_town(const SimulationParameters& parameters, int river);
[[nodiscard]] std::unique_ptr<World> make_park(const SimulationParameters& parameters);

}  // namespace groundloop::simulation
