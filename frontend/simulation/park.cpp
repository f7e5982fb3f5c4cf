// The park: paths of street_network.hpp over hills, between woods and meadows, with benches, lamps
// and bushes; no buildings and no cars. What `change` alters (foliage, bushes) has keys of its own.
#include <algorithm>
#include <cmath>

#include "frontend/simulation/random.hpp"
#include "frontend/simulation/scenery.hpp"
#include "frontend/simulation/street_network.hpp"
#include "frontend/simulation/street_route.hpp"
#include "frontend/simulation/terrain.hpp"
#include "frontend/simulation/world.hpp"

namespace groundloop::simulation {
namespace {

/// Below this nothing grows over a path, m; more than a walker's height, for slopes.
constexpr double trimmed = 3.2;

class Park final : public World {
 public:
  explicit Park(const SimulationParameters& parameters)
      : seed_(key_of(parameters.seed, 100)),
        day_(key_of(parameters.seed, 101, parameters.change)),
        foliage_(parameters.change == 0 ? 1.0
                                        : Random(key_of(parameters.change, 12)).uniform(0.25, 1.0)),
        network_(key_of(parameters.seed, 102), options()) {}

  double ground(const Vec2& p) const override {
    return 9.0 * value_noise(key_of(seed_, 1), p, 160.0) +
           2.0 * value_noise(key_of(seed_, 2), p, 47.0) +
           0.08 * value_noise(key_of(seed_, 3), p, 9.0);
  }
  double chunk_size() const override { return StreetNetwork::spacing; }
  double overhang() const override { return 90.0; }
  void build(const ChunkId& chunk, Mesh& mesh) const override;
  Way plan(const SimulationParameters& parameters) const override {
    Way way = plan_street_route(network_, parameters);
    way.cars = false;
    return way;
  }

 private:
  static StreetNetworkOptions options() {
    StreetNetworkOptions result;
    result.min_half_width = 1.3;
    result.max_half_width = 2.4;
    result.avenues = 0.0;
    result.min_pavement = 0.3;
    result.max_pavement = 0.6;
    result.bend = 30.0;
    return result;
  }
  [[nodiscard]] Vec3 on_ground(const Vec2& p) const { return {p.x(), p.y(), ground(p)}; }
  void line_path(Mesh& mesh, const Street& path, const std::vector<Street>& others) const;
  void plant(Mesh& mesh, const ChunkId& chunk, const std::vector<Street>& around) const;

  std::uint64_t seed_, day_;
  double foliage_;
  StreetNetwork network_;
};

void Park::build(const ChunkId& chunk, Mesh& mesh) const {
  const std::vector<Street> around = network_.around({chunk.i, chunk.j}, 2);
  add_terrain(
      mesh, chunk_size() * Vec2(chunk.i, chunk.j), chunk_size(), 2.0,
      [&](const Vec2& p) { return ground(p); },
      [&](const Vec2& p) {
        return clearance(around, p) < 0.0 ? Material::paving : Material::grass;
      });
  for (int axis = 0; axis < 2; ++axis) {
    const auto path = network_.street({chunk.i, chunk.j}, axis);
    if (!path) continue;
    std::vector<Street> others = around;
    std::erase_if(others, [&](const Street& s) { return s.key == path->key; });
    line_path(mesh, *path, others);
  }
  plant(mesh, chunk, around);
}

void Park::line_path(Mesh& mesh, const Street& path, const std::vector<Street>& others) const {
  Random random(key_of(path.key, 1));
  const double length = path.length(), edge = path.edge();
  const auto beside = [&](double x, double away) {
    const Vec2 d = path.direction(x / length);
    return Vec2(path.point(x / length) + away * Vec2(-d.y(), d.x()));
  };
  const bool lamps = random.chance(0.5), trees = random.chance(0.4);
  const double gap = random.uniform(8, 14);
  for (double x = random.uniform(8, 20); x < length - 8; x += random.uniform(15, 45)) {
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    // Benches face the path.
    const Vec2 forward = path.direction(x / length) * side, p = beside(x, side * (edge + 0.6));
    if (clearance(others, p) > 1.0) add_bench(mesh, Place{on_ground(p), forward});
  }
  for (double x = 12.0; lamps && x < length - 8; x += 28.0) {
    const Vec2 p = beside(x, edge + 0.3);
    if (clearance(others, p) < 0.5) continue;
    add_lamp(mesh, Place{on_ground(p), -path.direction(x / length)}, 4.0);
  }
  for (double x = 10.0; trees && x < length - 8; x += gap * random.uniform(0.8, 1.2)) {
    for (const double side : {-1.0, 1.0}) {
      const Tree tree{random.uniform(8, 13), foliage_, trimmed};
      const Random shape(random.bits());
      const Random season(key_of(day_, path.key, static_cast<std::int64_t>(10 * x), side > 0));
      const Vec2 p = beside(x, side * (edge + 1.8));
      if (clearance(others, p) > 1.0) add_tree(mesh, on_ground(p), tree, shape, season);
    }
  }
}

void Park::plant(Mesh& mesh, const ChunkId& chunk, const std::vector<Street>& around) const {
  Random random(key_of(seed_, 4, chunk.i, chunk.j)), day(key_of(day_, 4, chunk.i, chunk.j));
  const Vec2 corner = chunk_size() * Vec2(chunk.i - 0.5, chunk.j - 0.5);
  constexpr int tries = 260;
  for (int i = 0; i < tries; ++i) {
    const Vec2 p = corner + chunk_size() * Vec2(random.uniform(), random.uniform());
    const double height = random.uniform(5, 16), dice = random.uniform();
    const Random shape(random.bits()), season(day.bits());
    // Woods and meadows: trees stand where a slow noise is high.
    const double wood = value_noise(key_of(seed_, 5), p, 60.0);
    const double free = clearance(around, p);
    if (free < 1.5 || dice > std::clamp(0.25 + 0.6 * wood, 0.04, 0.7)) continue;
    const bool over_path = free < 0.4 * height + 1.0;
    add_tree(mesh, on_ground(p), {height, foliage_, over_path ? trimmed : 0.0}, shape, season);
  }
  for (int i = 0; i < 24; ++i) {  // bushes come and go
    const Vec2 p = corner + chunk_size() * Vec2(day.uniform(), day.uniform());
    const double heading = day.uniform(0, 6.28), size = day.uniform(0.5, 2.5);
    const double height = day.uniform(0.5, 1.6);
    const Vec2 half = size * Vec2(std::cos(heading), std::sin(heading));
    constexpr double margin = 1.5;
    if (std::min({clearance(around, p), clearance(around, p - half), clearance(around, p + half)}) <
        margin) {
      continue;
    }
    add_hedge(mesh, on_ground(p - half), on_ground(p + half), height, 1.2, day);
  }
}

}  // namespace

std::unique_ptr<World> make_park(const SimulationParameters& parameters) {
  return std::make_unique<Park>(parameters);
}

std::unique_ptr<World> make_world(const SimulationParameters& parameters) {
  constexpr int river = 4;  // in spacings of crossings
  if (parameters.world == "bridge") return make_town(parameters, river);
  if (parameters.world == "park") return make_park(parameters);
  return make_town(parameters, 0);
}

}  // namespace groundloop::simulation
