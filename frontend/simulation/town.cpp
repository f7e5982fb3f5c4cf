// The town: streets of street_network.hpp lined with houses, gardens, trees, parked cars and street
// furniture. With a river, two quarters of different build with one bridge between them. What
// `change` alters has keys of its own (parked cars, foliage, sheds); all else depends on the seed
// alone.
#include <algorithm>
#include <cmath>
#include <optional>

#include "frontend/simulation/bridge.hpp"
#include "frontend/simulation/random.hpp"
#include "frontend/simulation/scenery.hpp"
#include "frontend/simulation/street_network.hpp"
#include "frontend/simulation/street_route.hpp"
#include "frontend/simulation/terrain.hpp"
#include "frontend/simulation/world.hpp"

namespace groundloop::simulation {
namespace {

/// Below this nothing grows over a pavement, m.
constexpr double trimmed = 2.7;

class Town final : public World {
 public:
  Town(const SimulationParameters& parameters, int river)
      : seed_(key_of(parameters.seed, 10)),
        day_(key_of(parameters.seed, 11, parameters.change)),
        foliage_(parameters.change == 0 ? 1.0
                                        : Random(key_of(parameters.change, 12)).uniform(0.25, 1.0)),
        network_(key_of(parameters.seed, 13), options(river)) {
    if (river > 0) bridge_.emplace(*network_.street({0, 0}, 0));
  }

  double ground(const Vec2& p) const override {
    return bridge_ && bridge_->carries(p) ? 0.0 : terrain(p);
  }
  double chunk_size() const override { return StreetNetwork::spacing; }
  double overhang() const override { return 100.0; }
  void build(const ChunkId& chunk, Mesh& mesh) const override;
  Way plan(const SimulationParameters& parameters) const override {
    return plan_street_route(network_, parameters);
  }

 private:
  static StreetNetworkOptions options(int river) {
    StreetNetworkOptions result;
    result.river = river;
    return result;
  }
  /// The land without the bridge; level near a river, and low in its bed.
  [[nodiscard]] double terrain(const Vec2& p) const {
    const double land = 7.0 * value_noise(key_of(seed_, 1), p, 310.0) +
                        1.2 * value_noise(key_of(seed_, 2), p, 83.0) +
                        0.03 * value_noise(key_of(seed_, 3), p, 8.0);
    return bridge_ ? bridge_->bank(p, land) : land;
  }

  /// One side of a street: +1 is the left one.
  struct Side {
    const Street& street;
    const std::vector<Street>& others;  ///< the streets around without this one
    double sign;
    double length;
    [[nodiscard]] Vec2 at(double x, double away) const {
      const double t = std::clamp(x / length, 0.0, 1.0);
      const Vec2 d = street.direction(t);
      return street.point(t) + sign * away * Vec2(-d.y(), d.x());
    }
    [[nodiscard]] Vec2 along(double x) const {
      return street.direction(std::clamp(x / length, 0.0, 1.0));
    }
    [[nodiscard]] double kerb() const { return street.half_width; }
    [[nodiscard]] double front() const { return street.edge(); }
    /// Whether a point lies at least so many metres from all other streets.
    [[nodiscard]] bool free(const Vec2& p, double margin) const {
      return clearance(others, p) > margin;
    }
  };

  [[nodiscard]] Vec3 on_ground(const Vec2& p, double z = 0.0) const {
    return {p.x(), p.y(), ground(p) + z};
  }
  void build_pavement(Mesh& mesh, const Side& side) const;
  void build_lots(Mesh& mesh, const Side& side, Random random) const;
  void build_garden(Mesh& mesh, const Side& side, double x, double width, double depth,
                    Random& random, Random& day) const;
  void build_furniture(Mesh& mesh, const Side& side, Random random) const;
  void build_parked_cars(Mesh& mesh, const Side& side, double density) const;
  void build_green(Mesh& mesh, const ChunkId& chunk, const std::vector<Street>& around) const;

  std::uint64_t seed_, day_;
  double foliage_;
  StreetNetwork network_;
  std::optional<Bridge> bridge_;
};

void Town::build(const ChunkId& chunk, Mesh& mesh) const {
  // Squares of the world are numbered on through the river, crossings are not.
  const bool water = chunk.i > 0 && chunk.i <= network_.river();
  const Crossing crossing{chunk.i > 0 ? std::max(0, chunk.i - network_.river()) : chunk.i, chunk.j};
  const std::vector<Street> around = network_.around(crossing, 2);
  add_terrain(
      mesh, chunk_size() * Vec2(chunk.i, chunk.j), chunk_size(), 2.5,
      [&](const Vec2& p) { return ground(p); },
      [&](const Vec2& p) {
        const double free = clearance(around, p);
        return free < -2.0 ? Material::asphalt : free < 1.0 ? Material::paving : Material::grass;
      });
  if (bridge_) bridge_->build(mesh, 0.5 * chunk_size(), chunk_size() * Vec2(chunk.i, chunk.j));
  if (water) return;
  for (int axis = 0; axis < 2; ++axis) {
    const auto street = network_.street(crossing, axis);
    if (!street || street->bridge) continue;
    const double parking = Random(key_of(street->key, 1)).uniform(0.15, 0.8);
    std::vector<Street> others = around;
    std::erase_if(others, [&](const Street& s) { return s.key == street->key; });
    for (const double sign : {-1.0, 1.0}) {
      const Side side{*street, others, sign, street->length()};
      const std::uint64_t key = key_of(street->key, sign > 0);
      build_pavement(mesh, side);
      build_lots(mesh, side, Random(key_of(key, 2)));
      build_furniture(mesh, side, Random(key_of(key, 3)));
      build_parked_cars(mesh, side, parking);
    }
  }
  build_green(mesh, chunk, around);
}

void Town::build_pavement(Mesh& mesh, const Side& side) const {
  constexpr double kerb_height = 0.12, margin = 9.0;
  const int steps = std::max(1, static_cast<int>((side.length - 2 * margin) / 3.0));
  for (int i = 0; i < steps; ++i) {
    const double x0 = margin + (side.length - 2 * margin) * i / steps;
    const double x1 = margin + (side.length - 2 * margin) * (i + 1) / steps;
    const Vec3 a = on_ground(side.at(x0, side.kerb()), kerb_height);
    const Vec3 b = on_ground(side.at(x1, side.kerb()), kerb_height);
    const Vec3 c = on_ground(side.at(x1, side.front()), kerb_height);
    const Vec3 d = on_ground(side.at(x0, side.front()), kerb_height);
    mesh.quad(a, b, c, d, Material::paving);
    const Vec3 down(0, 0, -0.3);
    mesh.quad(a + down, b + down, b, a, Material::concrete);
  }
}

void Town::build_lots(Mesh& mesh, const Side& side, Random random) const {
  // Rows of houses, villas with gardens, or blocks of flats.
  // Beyond a river the town is newer and taller.
  const bool beyond = bridge_ && side.street.from.x() > StreetNetwork::spacing;
  const double kind =
      bridge_ ? random.uniform(beyond ? 0.55 : 0.0, beyond ? 1.0 : 0.65) : random.uniform();
  const bool rows = kind < 0.4, villas = kind < 0.75;
  const double typical_height = rows     ? random.uniform(6, 12)
                                : villas ? random.uniform(3.5, 7)
                                         : random.uniform(9, 18);
  double x = random.uniform(8, 14);
  while (x < side.length - 10) {
    Random day(key_of(day_, static_cast<std::int64_t>(side.sign), side.street.key,
                      static_cast<std::int64_t>(x)));
    const double width = rows ? random.uniform(6, 13) : random.uniform(9, 22);
    const double depth = random.uniform(8, 13);
    const double setback = rows ? random.uniform(0.0, 0.9) : random.uniform(2.0, 8.0);
    const double height = typical_height * random.uniform(0.75, 1.3);
    const double front = side.front() + setback;
    const bool empty = random.chance(0.14);
    const double middle = x + 0.5 * width;
    Vec2 forward = side.along(middle);
    // Seen from the house, the street runs the other way on the left-hand side.
    if (side.sign < 0) forward = -forward;
    // Houses stand a little askew, as their builders left them.
    const double skew = rows ? random.gauss(0.01) : random.gauss(0.05);
    forward = Vec2(forward.x() - skew * forward.y(), forward.y() + skew * forward.x()).normalized();
    const Vec2 left(-forward.y(), forward.x());
    const Vec2 corner = side.at(middle, front) - 0.5 * width * forward;
    // Free of all streets, its own among them where that bends.
    const auto free = [&](double y) {
      bool all = true;
      for (const double u : {0.0, 0.5, 1.0}) {
        const Vec2 p = corner + u * width * forward + y * left;
        all = all && side.free(p, 0.2) && clearance({side.street}, p) > -0.1;
      }
      return all;
    };
    if (!empty && free(0.1) && free(0.5 * depth) && free(depth)) {
      constexpr double wing = 8.0;
      const bool room = free(depth + 0.5 * wing) && free(depth + wing);
      const Lot lot{width, depth, setback + 0.1, room ? wing : 0.0};
      add_house(mesh,
                Place{on_ground(corner + 0.5 * width * forward) -
                          Vec3(0.5 * width * forward.x(), 0.5 * width * forward.y(), 0),
                      forward},
                lot, height, random);
    }
    if ((!rows || empty) && x + width < side.length - 8) {
      build_garden(mesh, side, x, width, setback, random, day);
    }
    x += width +
         (rows ? (random.chance(0.2) ? random.uniform(1.5, 4.0) : 0.0) : random.uniform(2.0, 9.0));
  }
}

void Town::build_garden(Mesh& mesh, const Side& side, double x, double width, double depth,
                        Random& random, Random& day) const {
  const double line = side.front() + 0.35;
  const Vec3 a = on_ground(side.at(x + 0.6, line)), b = on_ground(side.at(x + width - 2.8, line));
  const bool free = side.free(a.head<2>(), 0.5) && side.free(b.head<2>(), 0.5);
  const double kind = random.uniform(), height = random.uniform();
  if (kind < 0.4 && free) {
    add_hedge(mesh, a, b, 0.9 + 1.1 * height, 0.6, day);
  } else if (kind < 0.75 && free) {
    add_fence(mesh, a, b, 0.8 + 0.7 * height);
  }
  if (random.chance(0.6)) {
    const Vec2 p =
        side.at(x + random.uniform(1, width - 1), line + random.uniform(0.8, 1.0 + depth));
    const Tree tree{random.uniform(3, 9), foliage_, trimmed};
    const Random shape(random.bits()), season(day.bits());
    if (side.free(p, 0.6)) add_tree(mesh, on_ground(p), tree, shape, season);
  }
}

void Town::build_furniture(Mesh& mesh, const Side& side, Random random) const {
  const double lamp_gap = random.uniform(24, 38), start = random.uniform(10, 25);
  const Vec2 to_street_sign = Vec2::Constant(-side.sign);
  for (double x = start; x < side.length - 8; x += lamp_gap * random.uniform(0.9, 1.1)) {
    const Vec2 p = side.at(x, side.kerb() + 0.35);
    const Vec2 along = side.along(x) * (side.sign > 0 ? -1.0 : 1.0);
    const double height = random.uniform(4.5, 8.0);
    if (side.free(p, 0.4)) add_lamp(mesh, Place{on_ground(p), along}, height);
  }
  for (int i = random.below(4); i > 0; --i) {
    const double x = random.uniform(9, side.length - 9);
    const Vec2 p = side.at(x, side.kerb() + 0.45), along = side.along(x) * to_street_sign.x();
    if (side.free(p, 0.4)) add_sign(mesh, Place{on_ground(p), along}, random);
  }
  const bool avenue = random.chance(0.35);
  const double gap = random.uniform(8, 16);
  for (double x = random.uniform(11, 18); avenue && x < side.length - 10;
       x += gap * random.uniform(0.8, 1.3)) {
    const Vec2 p = side.at(x, side.kerb() + 0.45);
    const Tree tree{random.uniform(6, 11), foliage_, trimmed};
    const Random shape(random.bits());
    const Random season(key_of(day_, 20, side.street.key, static_cast<std::int64_t>(100 * x)));
    if (side.free(p, 0.6)) add_tree(mesh, on_ground(p), tree, shape, season);
  }
}

void Town::build_parked_cars(Mesh& mesh, const Side& side, double density) const {
  Random day(key_of(day_, 21, side.street.key, side.sign > 0));
  for (double x = 12.0; x < side.length - 14.0; x += day.uniform(5.6, 7.5)) {
    if (!day.chance(density)) continue;
    // Two wheels on the pavement, as is the custom in narrow streets.
    const Vec2 p = side.at(x, side.kerb() + day.uniform(-0.65, -0.45));
    Vec2 along = side.along(x) * (day.chance(0.85) == (side.sign > 0) ? -1.0 : 1.0);
    const double skew = day.gauss(0.015);
    along = Vec2(along.x() - skew * along.y(), along.y() + skew * along.x()).normalized();
    const Random shape(day.bits());
    if (side.free(p - 2.4 * along, 0.6) && side.free(p + 2.4 * along, 0.6)) {
      Random look = shape;
      add_car(mesh, Place{on_ground(p, 0.06), along}, look);
    }
  }
}

void Town::build_green(Mesh& mesh, const ChunkId& chunk, const std::vector<Street>& around) const {
  Random random(key_of(seed_, 22, chunk.i, chunk.j));
  Random day(key_of(day_, 22, chunk.i, chunk.j));
  const Vec2 corner = chunk_size() * Vec2(chunk.i - 0.5, chunk.j - 0.5);
  const int trees = 6 + random.below(26);
  for (int i = 0; i < trees; ++i) {
    const Vec2 p = corner + chunk_size() * Vec2(random.uniform(), random.uniform());
    const Tree tree{random.uniform(4, 13), foliage_};
    const Random shape(random.bits()), season(day.bits());
    if (clearance(around, p) < 16.0) continue;
    add_tree(mesh, on_ground(p), tree, shape, season);
  }
  for (int i = 0; i < 4; ++i) {
    const Vec2 p = corner + chunk_size() * Vec2(day.uniform(), day.uniform());
    if (clearance(around, p) < 3.0) continue;
    const double heading = day.uniform(0, 6.28);
    add_shed(mesh, Place{on_ground(p), Vec2(std::cos(heading), std::sin(heading))}, day);
  }
}

}  // namespace

std::unique_ptr<World> make_town(const SimulationParameters& parameters, int river) {
  return std::make_unique<Town>(parameters, river);
}

}  // namespace groundloop::simulation
