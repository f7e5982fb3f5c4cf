#include "frontend/simulation/street_route.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {
namespace {

/// The crossings that all routes of a given world and length keep to.
struct Quarter {
  Crossing low, high;  ///< included
  std::string side;

  Quarter(const StreetNetwork& network, const SimulationParameters& parameters)
      : side(parameters.side) {
    const double bridge = network.river() > 0 ? 2.0 * network.river() : 0.0;
    const double nodes = std::max(6.0, 0.6 * (parameters.length / StreetNetwork::spacing - bridge));
    const int width = static_cast<int>(std::ceil(std::sqrt(nodes)));
    const int height = static_cast<int>(std::ceil(nodes / width));
    low = {0, 0};
    high = {width - 1, height - 1};
    if (network.river() > 0) {  // half of it on either bank
      low = {1 - (width + 1) / 2, -height / 2};
      high = {(width + 1) / 2, low.j + height - 1};
    } else if (side != "any") {
      low = {side == "west" ? 1 - width : 0, 0};
      high = {side == "west" ? 0 : width - 1, std::max(2, height - 1)};
    }
  }
  [[nodiscard]] bool allows(const Crossing& from, const Crossing& to) const {
    if (to.i < low.i || to.j < low.j || to.i > high.i || to.j > high.j) return false;
    if (side == "any" || from.i != 0 || to.i != 0) return true;
    // Of the streets between west and east only one belongs to both.
    return std::min(from.j, to.j) == 1;
  }
  /// The first crossings of a way.
  [[nodiscard]] std::vector<Crossing> start(const StreetNetwork& network, Random& random) const {
    if (network.river() > 0) return {{random.chance(0.5) ? 0 : 1, 0}};
    if (side == "any") {
      return {{low.i + random.below(high.i - low.i + 1), low.j + random.below(high.j - low.j + 1)}};
    }
    // The common street, which is never missing, is driven first and in either direction.
    const bool north = random.chance(0.5);
    return {{0, north ? 1 : 2}, {0, north ? 2 : 1}};
  }
};

struct Walk {
  std::vector<Crossing> crossings;
  double length = 0.0;
  double same = 0.0, opposite = 0.0;  ///< metres driven again, by direction
};

Walk random_walk(const StreetNetwork& network, const Quarter& quarter, double length,
                 Random random) {
  Walk walk;
  walk.crossings = quarter.start(network, random);
  std::map<std::pair<Crossing, Crossing>, double> driven;  // to the path length then
  for (std::size_t k = 1; k < walk.crossings.size(); ++k) {
    const auto street = network.between(walk.crossings[k - 1], walk.crossings[k]);
    driven[{walk.crossings[k - 1], walk.crossings[k]}] = walk.length;
    walk.length += street->length();
  }
  while (walk.length < length) {
    const Crossing at = walk.crossings.back();
    struct Choice {
      Crossing to;
      double weight;
    };
    std::vector<Choice> choices;
    const Crossing back =
        walk.crossings.size() > 1 ? walk.crossings[walk.crossings.size() - 2] : at;
    for (const Crossing to : {Crossing{at.i + 1, at.j}, Crossing{at.i - 1, at.j},
                              Crossing{at.i, at.j + 1}, Crossing{at.i, at.j - 1}}) {
      const auto street = network.between(at, to);
      if (to == back || !street || !quarter.allows(at, to)) continue;
      const bool known = driven.count({at, to}) + driven.count({to, at}) > 0;
      choices.push_back({to, street->bridge ? 2.0 : known ? 0.35 : 1.0});
    }
    if (choices.empty()) choices.push_back({back, 1.0});  // a dead end of the quarter
    double total = 0.0;
    for (const Choice& c : choices) total += c.weight;
    double pick = random.uniform() * total;
    Crossing to = choices.back().to;
    for (const Choice& c : choices) {
      pick -= c.weight;
      if (pick < 0.0) {
        to = c.to;
        break;
      }
    }
    if (to == at) break;
    const double step = network.between(at, to)->length();
    const auto again = [&](const Crossing& a, const Crossing& b) {
      const auto known = driven.find({a, b});
      return known != driven.end() && walk.length - known->second > 250.0;
    };
    if (again(at, to)) walk.same += step;
    if (again(to, at)) walk.opposite += step;
    driven[{at, to}] = walk.length;
    walk.length += step;
    walk.crossings.push_back(to);
  }
  return walk;
}

/// A corner at a crossing, rounded: from the end of one street's lane to the start of the next.
void add_corner(std::vector<Vec2>& line, const Vec2& from, const Vec2& direction_from,
                const Vec2& to, const Vec2& direction_to) {
  const double reach = 0.55 * (to - from).norm();
  const Vec2 a = from + reach * direction_from, b = to - reach * direction_to;
  constexpr int steps = 24;
  for (int i = 1; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps, s = 1.0 - t;
    line.emplace_back(s * s * s * from + 3 * s * s * t * a + 3 * s * t * t * b + t * t * t * to);
  }
}

/// Metres to the right of the street's middle that the carrier keeps on one drive of a street.
double choose_lane(const Street& street, const std::string& carrier, Random& random) {
  if (carrier != "car") return street.walking_line() + random.uniform(-0.2, 0.2);
  // Now nearer the kerb, now nearer the middle, and on avenues in the one lane or the other: a
  // revisit is never quite in the same track. Parked cars reach 1.7 m into the street.
  const double outermost = std::max(0.9, street.half_width - 2.6);
  const bool outer = outermost > 4.0 && random.chance(0.5);
  const double wish = outer ? outermost - 0.3 : street.driving_lane();
  return std::clamp(wish + random.gauss(0.3), 0.9, outermost);
}

}  // namespace

std::vector<Crossing> choose_crossings(const StreetNetwork& network,
                                       const SimulationParameters& parameters) {
  const Quarter quarter(network, parameters);
  // Of many random walks the one that comes back most, in both directions: a quarter of the way
  // each is asked for.
  constexpr int trials = 48;
  Walk best;
  double best_score = -1e9;
  for (int trial = 0; trial < trials; ++trial) {
    Walk walk = random_walk(network, quarter, parameters.length + 60.0,
                            Random(key_of(parameters.seed, 30, parameters.route, trial)));
    const double wanted = 0.22 * parameters.length;
    const double score = std::min(walk.same, wanted) + std::min(walk.opposite, wanted) -
                         0.3 * std::max(0.0, walk.same + walk.opposite - 2.5 * wanted) +
                         std::min(0.0, walk.length - parameters.length);
    if (score > best_score) {
      best_score = score;
      best = std::move(walk);
    }
  }
  return best.crossings;
}

Way plan_street_route(const StreetNetwork& network, const SimulationParameters& parameters) {
  std::vector<Crossing> crossings = choose_crossings(network, parameters);
  if (parameters.way == "back") std::reverse(crossings.begin(), crossings.end());
  std::vector<Street> streets;
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
    streets.push_back(*network.between(crossings[k], crossings[k + 1]));
  }
  const bool car = parameters.carrier == "car";
  // What is cut off a street where it meets another; who walks turns where the pavements meet.
  const auto corner = [&](std::size_t other) {
    return car || other >= streets.size() ? 9.0 : std::max(9.0, streets[other].edge() + 0.3);
  };
  Way way;
  Random random(key_of(parameters.seed, 31, parameters.route));
  const auto pad = [&](const Street& street, double lane) {
    // Cars of the carrier's own direction drive where it does, or beside it where it walks.
    way.along.resize(way.points.size(), car ? 0.0 : lane - street.driving_lane());
    way.oncoming.resize(way.points.size(), lane + (car ? lane : street.driving_lane()));
    way.centre.resize(way.points.size(), lane);
    way.pavement.resize(way.points.size(), street.walking_line());
  };
  Vec2 last_direction = Vec2::Zero();
  for (std::size_t k = 0; k < streets.size(); ++k) {
    const Street& street = streets[k];
    const double length = street.length();
    const double lane = choose_lane(street, parameters.carrier, random);
    const double begin = corner(k - 1), end = length - corner(k + 1);
    const int steps = std::max(1, static_cast<int>(end - begin));
    for (int i = 0; i <= steps; ++i) {
      const double t = (begin + (end - begin) * i / steps) / length;
      const Vec2 d = street.direction(t);
      const Vec2 p = street.point(t) + lane * Vec2(d.y(), -d.x());
      if (i == 0 && !way.points.empty()) {
        const Vec2 from = way.points.back();
        way.stops.push_back(way.points.size() - 1);
        add_corner(way.points, from, last_direction, p, d);
        pad(street, lane);
      }
      way.points.push_back(p);
      last_direction = d;
    }
    pad(street, lane);
  }
  return way;
}

}  // namespace groundloop::simulation
