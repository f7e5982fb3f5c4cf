#include "frontend/simulation/scenery.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace groundloop::simulation {

void add_tree(Mesh& mesh, const Vec3& foot, const Tree& tree, Random shape, Random season) {
  const double height = tree.height;
  const double trunk = height * shape.uniform(0.2, 0.35);
  const double lean_x = shape.uniform(-0.04, 0.04), lean_y = shape.uniform(-0.04, 0.04);
  const double radius = height * shape.uniform(0.018, 0.03);
  const double crown_radius = height * shape.uniform(0.22, 0.36);
  add_column(mesh, foot - Vec3(0, 0, 0.3), radius, 0.6 * radius, 0.8 * height, 6, Material::wood);
  const Vec3 centre =
      foot + Vec3(lean_x * height, lean_y * height, 0.5 * (trunk + height) + 0.05 * height);
  const double half_height = 0.5 * (height - trunk);
  for (int i = 0; i < 5; ++i) {  // boughs
    const double angle = shape.uniform(0, 2 * std::numbers::pi);
    const Vec3 tip =
        centre + Vec3(0.7 * crown_radius * std::cos(angle), 0.7 * crown_radius * std::sin(angle),
                      half_height * shape.uniform(-0.3, 0.5));
    const double root = trunk * shape.uniform(0.9, 1.5);
    if (std::min(root, tip.z() - foot.z()) < tree.clear) continue;
    add_bar(mesh, foot + Vec3(0, 0, root), tip, radius, Material::wood);
  }
  const int clumps =
      static_cast<int>(tree.foliage * std::min(240.0, 26.0 * crown_radius * half_height));
  for (int i = 0; i < clumps; ++i) {
    Vec3 p;
    do {
      p = Vec3(season.uniform(-1, 1), season.uniform(-1, 1), season.uniform(-1, 1));
    } while (p.squaredNorm() > 1.0 || p.squaredNorm() < 0.12);
    p = centre + Vec3(crown_radius * p.x(), crown_radius * p.y(), half_height * p.z());
    const double size = season.uniform(0.18, 0.42);
    const auto corner = [&]() -> Vec3 {
      return p + size * Vec3(season.uniform(-1, 1), season.uniform(-1, 1), season.uniform(-1, 1));
    };
    const Vec3 a = corner(), b = corner(), c = corner();
    if (std::min({a.z(), b.z(), c.z()}) - foot.z() < tree.clear) continue;
    mesh.triangle(a, b, c, Material::leaves);
  }
}

void add_car(Mesh& mesh, const Place& place, Random& random) {
  const bool van = random.chance(0.18);
  const double length = van ? random.uniform(4.8, 6.0) : random.uniform(3.8, 4.8);
  const double half = 0.5 * length, side = van ? 1.0 : random.uniform(0.84, 0.94);
  const double belt = van ? 1.15 : random.uniform(0.8, 0.95);
  const double top = van ? random.uniform(1.9, 2.5) : random.uniform(1.4, 1.65);
  add_box(mesh, place, {-half, -side, 0.25}, {half, side, belt}, Material::paint);
  // The cabin, narrower at the top: panes are glass, the roof is painted.
  const double nose = van ? 0.65 * half : 0.35 * half, tail = van ? -half : -0.8 * half;
  const double roof_nose = nose - 0.6, roof_tail = tail + (van ? 0.05 : 0.5);
  const double upper = side - (van ? 0.05 : 0.2);
  const Vec3 a = place.at(nose, -side, belt), b = place.at(nose, side, belt),
             c = place.at(tail, side, belt), d = place.at(tail, -side, belt);
  const Vec3 e = place.at(roof_nose, -upper, top), f = place.at(roof_nose, upper, top),
             g = place.at(roof_tail, upper, top), h = place.at(roof_tail, -upper, top);
  const Material rear = van ? Material::paint : Material::glass;
  mesh.quad(a, b, f, e, Material::glass);
  mesh.quad(b, c, g, f, rear);
  mesh.quad(c, d, h, g, rear);
  mesh.quad(d, a, e, h, rear);
  mesh.quad(e, f, g, h, Material::paint);
  for (const double x : {-0.62 * half, 0.62 * half}) {
    for (const double y : {-side, side - 0.2}) {
      add_box(mesh, place, {x - 0.3, y, 0.0}, {x + 0.3, y + 0.2, 0.55}, Material::cloth);
    }
  }
}

void add_person(Mesh& mesh, const Place& place, Random& random) {
  const double height = random.uniform(1.5, 1.95), stride = random.uniform(0.05, 0.3);
  add_box(mesh, place, {stride - 0.08, -0.18, 0}, {stride + 0.08, -0.03, 0.45 * height},
          Material::cloth);
  add_box(mesh, place, {-stride - 0.08, 0.03, 0}, {-stride + 0.08, 0.18, 0.45 * height},
          Material::cloth);
  add_box(mesh, place, {-0.13, -0.24, 0.42 * height}, {0.13, 0.24, 0.83 * height}, Material::cloth);
  add_column(mesh, place.at(0, 0, 0.83 * height), 0.1, 0.09, 0.17 * height, 6, Material::cloth);
}

void add_hedge(Mesh& mesh, const Vec3& from, const Vec3& to, double height, double width,
               Random& random) {
  const Vec3 along = to - from;
  const int pieces = std::max(1, static_cast<int>(along.norm() / 0.7));
  const Vec2 normal = Vec2(-along.y(), along.x()).normalized();
  const auto shaken = [&](const Vec3& p) {
    return Vec3(p + Vec3(random.uniform(-0.12, 0.12), random.uniform(-0.12, 0.12),
                         random.uniform(-0.12, 0.12)));
  };
  for (int i = 0; i < pieces; ++i) {
    const Vec3 a = from + along * (static_cast<double>(i) / pieces);
    const Vec3 b = from + along * ((i + 1.0) / pieces);
    const Vec3 aside(0.5 * width * normal.x(), 0.5 * width * normal.y(), 0);
    const Vec3 up(0, 0, height);
    const Vec3 down(0, 0, -0.3);
    mesh.quad(a - aside + down, b - aside + down, shaken(b - aside + up), shaken(a - aside + up),
              Material::leaves);
    mesh.quad(a + aside + down, b + aside + down, shaken(b + aside + up), shaken(a + aside + up),
              Material::leaves);
    mesh.quad(shaken(a - aside + up), shaken(b - aside + up), shaken(b + aside + up),
              shaken(a + aside + up), Material::leaves);
  }
}

void add_fence(Mesh& mesh, const Vec3& from, const Vec3& to, double height) {
  const Vec3 along = to - from;
  const int posts = std::max(1, static_cast<int>(along.norm() / 1.6));
  for (int i = 0; i <= posts; ++i) {
    const Vec3 p = from + along * (static_cast<double>(i) / posts);
    add_bar(mesh, p - Vec3(0, 0, 0.3), p + Vec3(0, 0, height), 0.09, Material::wood);
  }
  for (const double level : {0.35, 0.65, 0.95}) {
    const Vec3 up(0, 0, level * height);
    add_bar(mesh, from + up, to + up, 0.1, Material::wood);
  }
}

void add_lamp(Mesh& mesh, const Place& place, double height) {
  add_column(mesh, place.at(0, 0, -0.3), 0.09, 0.05, height + 0.3, 6, Material::metal);
  add_bar(mesh, place.at(0, 0, height), place.at(0, 1.4, height + 0.15), 0.08, Material::metal);
  add_box(mesh, place, {-0.12, 1.2, height + 0.05}, {0.12, 1.7, height + 0.2}, Material::metal);
}

void add_sign(Mesh& mesh, const Place& place, Random& random) {
  const double height = random.uniform(2.0, 2.6), half = random.uniform(0.25, 0.45);
  add_column(mesh, place.at(0, 0, -0.3), 0.04, 0.04, height + 0.9, 5, Material::metal);
  mesh.quad(place.at(-0.06, -half, height), place.at(-0.06, half, height),
            place.at(-0.06, half, height + 0.7), place.at(-0.06, -half, height + 0.7),
            Material::sign);
}

void add_bench(Mesh& mesh, const Place& place) {
  add_box(mesh, place, {-0.9, -0.25, 0.38}, {0.9, 0.25, 0.46}, Material::wood);
  add_box(mesh, place, {-0.9, 0.22, 0.46}, {0.9, 0.28, 0.9}, Material::wood);
  for (const double x : {-0.7, 0.65}) {
    add_box(mesh, place, {x, -0.2, -0.2}, {x + 0.08, 0.2, 0.38}, Material::concrete);
  }
}

void add_shed(Mesh& mesh, const Place& place, Random& random) {
  const double half = random.uniform(1.2, 2.6), depth = random.uniform(2.0, 3.5);
  Block block{-half, half, 0.0, depth};
  block.foot = -0.5;
  block.eaves = random.uniform(2.0, 2.6);
  block.roof = random.uniform(0.4, 1.0);
  block.windows = false;
  add_block(mesh, place, block, random);
}

}  // namespace groundloop::simulation
