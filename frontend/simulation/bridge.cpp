#include "frontend/simulation/bridge.hpp"

#include <algorithm>
#include <cmath>

#include "frontend/simulation/scenery.hpp"

namespace groundloop::simulation {
namespace {

constexpr double bed = -9.0;          // of the river, m below the deck
constexpr double abutment = 60.0;     // from a crossing to the first bay, m
constexpr double level_reach = 80.0;  // over which the land comes down to the bridge's level, m

double ramp(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Bridge::Bridge(const Street& street)
    : street_(street),
      along_((street.to - street.from).normalized()),
      half_width_(street.half_width + street.pavement) {
  const double length = (street.to - street.from).norm() - 2.0 * abutment;
  bays_ = static_cast<int>(length / period);
  start_ = 0.5 * (street.from + street.to) - 0.5 * bays_ * period * along_;
  west_ = start_.x() + 6.0;
  east_ = start_.x() + bays_ * period * along_.x() - 6.0;
}

bool Bridge::carries(const Vec2& p) const {
  const Vec2 d = p - street_.from;
  const double s = along_.dot(d), away = along_.x() * d.y() - along_.y() * d.x();
  return std::abs(away) < half_width_ + 1.0 && s > 0.0 && s < (street_.to - street_.from).norm();
}

bool Bridge::over_water(const Vec2& p) const { return p.x() > west_ + 8.0 && p.x() < east_ - 8.0; }

double Bridge::bank(const Vec2& p, double land) const {
  const double inland = std::max(street_.from.x() - p.x(), p.x() - street_.to.x());
  const double level = land * ramp(inland / level_reach);
  const double depth = std::min(p.x() - west_, east_ - p.x());
  return level + bed * ramp(depth / 8.0);
}

void Bridge::build(Mesh& mesh, double half_size, const Vec2& centre) const {
  for (int k = 0; k < bays_; ++k) {
    const Vec2 start = start_ + k * period * along_;
    const Vec2 d = start + 0.5 * period * along_ - centre;
    // Half-open, so that neighbouring squares share no bay.
    if (d.x() >= -half_size && d.x() < half_size && d.y() >= -half_size && d.y() < half_size) {
      build_bay(mesh, start);
    }
  }
}

void Bridge::build_bay(Mesh& mesh, const Vec2& start) const {
  const Place place{Vec3(start.x(), start.y(), 0.0), along_};
  const double road = street_.half_width, edge = half_width_;
  add_box(mesh, place, {0, -edge, -1.0}, {period, edge, 0.0}, Material::asphalt);
  for (const double side : {-1.0, 1.0}) {
    const double low = std::min(side * road, side * edge),
                 high = std::max(side * road, side * edge);
    add_box(mesh, place, {0, low, 0.0}, {period, high, 0.12}, Material::paving);
    // The railing, its posts two metres apart.
    const double rail = side * (edge - 0.1);
    for (double x = 0.0; x < period; x += 2.0) {
      add_box(mesh, place, {x - 0.05, rail - 0.05, 0.0}, {x + 0.05, rail + 0.05, 1.1},
              Material::metal);
    }
    for (const double z : {0.35, 0.7, 1.05}) {
      add_bar(mesh, place.at(0, rail, z), place.at(period, rail, z), 0.06, Material::metal);
    }
    // One arch a bay between kerb and pavement, with hangers.
    constexpr int pieces = 12;
    const double line = side * (road + 0.3);
    const auto arch = [&](int i) {
      const double u = static_cast<double>(i) / pieces;
      return place.at(period * u, line, 22.0 * u * (1.0 - u));
    };
    for (int i = 0; i < pieces; ++i) {
      add_bar(mesh, arch(i), arch(i + 1), 0.4, Material::concrete);
      if (i > 0 && i % 2 == 0) {
        const Vec3 top = arch(i);
        add_bar(mesh, Vec3(top.x(), top.y(), 0.1), top, 0.12, Material::metal);
      }
    }
    const Place lamp{place.at(0.5 * period, side * (edge - 0.4), 0.1), -side * along_};
    add_lamp(mesh, lamp, 6.5);
    add_box(mesh, place, {-0.8, low, bed - 1.0}, {0.8, high, 0.0}, Material::concrete);  // pier
  }
  // A strut over the road at every crown.
  add_bar(mesh, place.at(0.5 * period, -road - 0.3, 5.5), place.at(0.5 * period, road + 0.3, 5.5),
          0.3, Material::concrete);
}

}  // namespace groundloop::simulation
