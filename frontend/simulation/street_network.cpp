#include "frontend/simulation/street_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {

Vec2 Street::point(double t) const {
  return (1 - t) * (1 - t) * from + 2 * t * (1 - t) * bend + t * t * to;
}

Vec2 Street::direction(double t) const {
  return ((1 - t) * (bend - from) + t * (to - bend)).normalized();
}

double Street::length() const {
  constexpr int steps = 16;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    sum += (point((i + 1.0) / steps) - point(static_cast<double>(i) / steps)).norm();
  }
  return sum;
}

Vec2 StreetNetwork::crossing(const Crossing& c) const {
  Random random(key_of(key_, 1, c.i, c.j));
  Vec2 jitter(random.uniform(-24, 24), random.uniform(-24, 24));
  if (options_.river > 0 && (c.i == 0 || c.i == 1)) jitter.x() = 0.0;  // along the quays
  return spacing * Vec2(c.i + (c.i > 0 ? options_.river : 0), c.j) + jitter;
}

std::optional<Street> StreetNetwork::street(const Crossing& c, int axis) const {
  Random random(key_of(key_, 2, c.i, c.j, axis));
  Street street;
  street.bridge = options_.river > 0 && axis == 0 && c.i == 0;
  if (street.bridge && c.j != 0) return std::nullopt;
  // Only streets to the east and north of even crossings may be missing: each crossing then keeps
  // two of its four.
  const bool may_be_missing = ((c.i + c.j) & 1) == 0 && !street.bridge;
  if (may_be_missing && random.chance(0.22)) return std::nullopt;
  street.key = random.bits();
  street.from = crossing(c);
  street.to = crossing(axis == 0 ? Crossing{c.i + 1, c.j} : Crossing{c.i, c.j + 1});
  const Vec2 along = (street.to - street.from).normalized();
  const double bend = street.bridge ? 0.0 : random.uniform(-options_.bend, options_.bend);
  street.bend = 0.5 * (street.from + street.to) + bend * Vec2(-along.y(), along.x());
  street.half_width = random.uniform(options_.min_half_width, options_.max_half_width);
  street.pavement = random.uniform(options_.min_pavement, options_.max_pavement);
  if (random.chance(options_.avenues)) street.half_width += 3.2;
  return street;
}

std::optional<Street> StreetNetwork::between(const Crossing& a, const Crossing& b) const {
  const int axis = a.j == b.j ? 0 : 1;
  if (a < b) return street(a, axis);
  std::optional<Street> reversed = street(b, axis);
  if (reversed) std::swap(reversed->from, reversed->to);
  return reversed;
}

std::vector<Street> StreetNetwork::around(const Crossing& c, int reach) const {
  std::vector<Street> streets;
  for (int i = c.i - reach; i <= c.i + reach; ++i) {
    for (int j = c.j - reach; j <= c.j + reach; ++j) {
      for (int axis = 0; axis < 2; ++axis) {
        if (const auto s = street({i, j}, axis)) streets.push_back(*s);
      }
    }
  }
  return streets;
}

double clearance(const std::vector<Street>& streets, const Vec2& p) {
  constexpr int steps = 8;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Street& street : streets) {
    const double edge = street.edge();
    // The curve stays within the triangle of its control points: far ones need no closer look.
    const Vec2 middle = 0.5 * (street.from + street.to);
    const double reach = 0.5 * (street.to - street.from).norm() + (street.bend - middle).norm();
    if ((p - middle).norm() - reach - edge > std::min(nearest, 60.0)) continue;
    for (int i = 0; i < steps; ++i) {
      const Vec2 a = street.point(static_cast<double>(i) / steps);
      const Vec2 ab = street.point((i + 1.0) / steps) - a;
      const double s = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + s * ab - p).norm() - edge);
    }
  }
  return nearest;
}

}  // namespace groundloop::simulation
