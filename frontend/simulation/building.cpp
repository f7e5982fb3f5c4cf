#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "frontend/simulation/scenery.hpp"

namespace groundloop::simulation {
namespace {

/// How a building's walls are made; one for all its walls.
struct FacadeStyle {
  double bay = 3.0;           ///< from window to window, m
  double storey = 3.0;        ///< m
  double window_width = 1.2;  ///< m
  double window_height = 1.5;
  double sill = 0.9;
  double recess = 0.18;  ///< depth of the panes behind the wall, m
  double pillar = 0.0;   ///< how far pillars stand out between the bays; 0: none
  Material wall = Material::plaster;

  explicit FacadeStyle(Random& random) {
    bay = random.uniform(2.3, 4.2);
    storey = random.uniform(2.7, 3.4);
    window_width = bay * random.uniform(0.3, 0.55);
    window_height = random.uniform(1.1, 1.8);
    sill = random.uniform(0.6, 1.0);
    recess = random.uniform(0.08, 0.35);
    if (random.chance(0.3)) pillar = random.uniform(0.15, 0.45);
    wall = random.chance(0.6) ? Material::plaster : Material::brick;
  }
};

/// An upright wall from a to b (seen from outside, left to right), z from `foot` to `eaves`.
struct Wall {
  Mesh& mesh;
  Vec3 a;
  Vec2 along;
  Vec2 inward;
  double width;

  Wall(Mesh& m, const Vec3& from, const Vec3& to)
      : mesh(m), a(from), along((to - from).head<2>()), inward(), width(along.norm()) {
    along /= width;
    inward = Vec2(-along.y(), along.x());
  }
  [[nodiscard]] Vec3 at(double x, double z, double depth = 0.0) const {
    return a + Vec3(along.x() * x + inward.x() * depth, along.y() * x + inward.y() * depth, z);
  }
  void panel(double x0, double x1, double z0, double z1, Material material,
             double depth = 0.0) const {
    mesh.quad(at(x0, z0, depth), at(x1, z0, depth), at(x1, z1, depth), at(x0, z1, depth), material);
  }
  void window(double x0, double x1, double z0, double z1, const FacadeStyle& style) const {
    panel(x0, x1, z0, z1, Material::glass, style.recess);
    for (const double x : {x0, x1}) {
      mesh.quad(at(x, z0), at(x, z1), at(x, z1, style.recess), at(x, z0, style.recess), style.wall);
    }
    for (const double z : {z0, z1}) {
      mesh.quad(at(x0, z), at(x1, z), at(x1, z, style.recess), at(x0, z, style.recess), style.wall);
    }
  }
};

void add_wall(Mesh& mesh, const Vec3& a, const Vec3& b, double foot, double eaves, bool windows,
              const FacadeStyle& style, Random& random) {
  const Wall wall(mesh, a, b);
  const int bays = static_cast<int>(wall.width / style.bay);
  const int storeys = static_cast<int>((eaves + 0.3) / style.storey);
  if (!windows || bays == 0 || storeys == 0) {
    wall.panel(0, wall.width, foot, eaves, style.wall);
    return;
  }
  const double bay = wall.width / bays, margin = 0.5 * (bay - style.window_width);
  double z = foot;
  for (int s = 0; s < storeys; ++s) {
    const double low = s * style.storey + style.sill;
    const double high = std::min(low + style.window_height, eaves - 0.2);
    if (high <= low) break;
    wall.panel(0, wall.width, z, low, style.wall);
    double x = 0.0;
    for (int k = 0; k < bays; ++k) {
      if (random.chance(0.12)) continue;  // a blind bay
      const double left = k * bay + margin, right = left + style.window_width;
      wall.panel(x, left, low, high, style.wall);
      wall.window(left, right, low, high, style);
      x = right;
    }
    wall.panel(x, wall.width, low, high, style.wall);
    z = high;
  }
  wall.panel(0, wall.width, z, eaves, style.wall);
  for (int k = 0; style.pillar > 0.0 && k <= bays; ++k) {
    const double x = std::clamp(k * bay, 0.2, wall.width - 0.2);
    const Vec3 foot_point = wall.at(x, foot);
    Place place{foot_point, wall.along};
    add_box(mesh, place, {-0.18, -style.pillar, 0}, {0.18, 0, eaves - foot}, Material::concrete);
  }
}

void add_roof(Mesh& mesh, const Place& place, const Block& b) {
  if (b.roof <= 0.0) {
    // A parapet around a flat roof, standing out a little.
    const double o = 0.5 * b.overhang, z = b.eaves;
    mesh.quad(place.at(b.x0, b.y0, z), place.at(b.x1, b.y0, z), place.at(b.x1, b.y1, z),
              place.at(b.x0, b.y1, z), Material::roof);
    add_box(mesh, place, {b.x0 - o, b.y0 - o, z - 0.3}, {b.x1 + o, b.y0 + 0.2, z + 0.6},
            Material::concrete);
    add_box(mesh, place, {b.x0 - o, b.y1 - 0.2, z - 0.3}, {b.x1 + o, b.y1 + o, z + 0.6},
            Material::concrete);
    add_box(mesh, place, {b.x0 - o, b.y0, z - 0.3}, {b.x0 + 0.2, b.y1, z + 0.6},
            Material::concrete);
    add_box(mesh, place, {b.x1 - 0.2, b.y0, z - 0.3}, {b.x1 + o, b.y1, z + 0.6},
            Material::concrete);
    return;
  }
  // A gable whose ridge runs along the longer side; the eaves stand out by the overhang.
  const bool along_x = b.x1 - b.x0 >= b.y1 - b.y0;
  const double o = b.overhang;
  const double half = 0.5 * (along_x ? b.y1 - b.y0 : b.x1 - b.x0);
  const double low = b.eaves - o * b.roof / half, high = b.eaves + b.roof;
  const auto at = [&](double u, double v, double z) {
    return along_x ? place.at(u, v, z) : place.at(v, u, z);
  };
  const double u0 = along_x ? b.x0 : b.y0, u1 = along_x ? b.x1 : b.y1;
  const double v0 = along_x ? b.y0 : b.x0, v1 = along_x ? b.y1 : b.x1, v = 0.5 * (v0 + v1);
  mesh.quad(at(u0 - o, v0 - o, low), at(u1 + o, v0 - o, low), at(u1 + o, v, high),
            at(u0 - o, v, high), Material::roof);
  mesh.quad(at(u0 - o, v1 + o, low), at(u1 + o, v1 + o, low), at(u1 + o, v, high),
            at(u0 - o, v, high), Material::roof);
  for (const double u : {u0, u1}) {
    mesh.triangle(at(u, v0, b.eaves), at(u, v1, b.eaves), at(u, v, high - 0.02), Material::plaster);
  }
}

}  // namespace

void add_block(Mesh& mesh, const Place& place, const Block& b, Random style_random) {
  const FacadeStyle style(style_random);
  const std::array<Vec3, 4> corners{place.at(b.x0, b.y0, 0), place.at(b.x1, b.y0, 0),
                                    place.at(b.x1, b.y1, 0), place.at(b.x0, b.y1, 0)};
  for (std::size_t i = 0; i < 4; ++i) {
    add_wall(mesh, corners[i], corners[(i + 1) % 4], b.foot, b.eaves, b.windows, style,
             style_random);
  }
  add_roof(mesh, place, b);
}

void add_house(Mesh& mesh, const Place& place, const Lot& lot, double height, Random& random) {
  const double width = lot.width, depth = lot.depth;
  const Random style(random.bits());
  Block main{0, width, 0, depth};
  main.eaves = height;
  main.foot = -1.5;
  main.overhang = random.uniform(0.1, 0.7);
  if (random.chance(0.65)) main.roof = random.uniform(0.25, 0.5) * std::min(width, depth);
  add_block(mesh, place, main, style);
  if (random.chance(0.35)) {  // a wing to the rear
    Block wing = main;
    wing.x0 = random.chance(0.5) ? 0.0 : 0.55 * width;
    wing.x1 = wing.x0 + 0.45 * width;
    wing.y0 = depth;
    wing.y1 = depth + random.uniform(3, 8);
    wing.eaves = height * random.uniform(0.5, 0.9);
    wing.roof = main.roof > 0.0 ? 0.35 * std::min(0.45 * width, wing.y1 - wing.y0) : 0.0;
    if (wing.y1 - wing.y0 <= lot.behind) add_block(mesh, place, wing, style);
  }
  if (random.chance(0.4)) {  // a bay or porch to the street
    const double bay = random.uniform(1.6, 3.5),
                 at = random.uniform(0.0, std::max(0.1, width - bay));
    Block porch{at, at + bay, -std::min(lot.before, random.uniform(0.6, 1.5)), 0.0};
    porch.foot = -1.5;
    porch.eaves = random.chance(0.5) ? std::min(height, 2.8) : height;
    porch.overhang = 0.2;
    if (porch.y0 < -0.3) add_block(mesh, place, porch, style);
  }
  const int balconies = random.chance(0.3) ? random.below(4) : 0;
  for (int i = 0; i < balconies; ++i) {
    const double z = 3.0 * (1 + random.below(3));
    if (z + 1.5 > height) continue;
    const double x = random.uniform(0.3, std::max(0.4, width - 3.0));
    add_box(mesh, place, {x, -1.2, z - 0.2}, {x + 2.6, 0, z}, Material::concrete);
    add_box(mesh, place, {x, -1.25, z}, {x + 2.6, -1.15, z + 1.0}, Material::metal);
  }
}

}  // namespace groundloop::simulation
