#include "frontend/simulation/mesh.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace groundloop::simulation {

const MaterialProperties& properties(Material material) {
  static constexpr std::array<MaterialProperties, static_cast<std::size_t>(Material::count)> table{{
      {0.17, 0.02},  // asphalt
      {0.25, 0.01},  // paving
      {0.35, 0.02},  // grass
      {0.60, 0.00},  // plaster
      {0.35, 0.00},  // brick
      {0.40, 0.00},  // concrete
      {0.10, 0.65},  // glass
      {0.25, 0.01},  // roof
      {0.40, 0.01},  // wood
      {0.45, 0.05},  // leaves
      {0.30, 0.08},  // metal
      {0.45, 0.10},  // paint
      {0.90, 0.00},  // sign
      {0.35, 0.03},  // cloth
      {0.02, 0.90},  // water
  }};
  return table[static_cast<std::size_t>(material)];
}

std::uint32_t Mesh::vertex(const Vec3& p) {
  vertices.emplace_back((p - origin).cast<float>());
  return static_cast<std::uint32_t>(vertices.size() - 1);
}

void Mesh::triangle(const Vec3& a, const Vec3& b, const Vec3& c, Material material) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  triangles.push_back({first, first + 1, first + 2});
  materials.push_back(material);
}

void Mesh::quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Material material) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  vertex(d);
  triangles.push_back({first, first + 1, first + 2});
  triangles.push_back({first, first + 2, first + 3});
  materials.insert(materials.end(), 2, material);
}

void add_box(Mesh& mesh, const Place& place, const Vec3& low, const Vec3& high, Material material) {
  const std::array<Vec3, 8> p{
      place.at(low.x(), low.y(), low.z()),    place.at(high.x(), low.y(), low.z()),
      place.at(high.x(), high.y(), low.z()),  place.at(low.x(), high.y(), low.z()),
      place.at(low.x(), low.y(), high.z()),   place.at(high.x(), low.y(), high.z()),
      place.at(high.x(), high.y(), high.z()), place.at(low.x(), high.y(), high.z())};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t j = (i + 1) % 4;
    mesh.quad(p[i], p[j], p[j + 4], p[i + 4], material);
  }
  mesh.quad(p[4], p[5], p[6], p[7], material);
}

void add_column(Mesh& mesh, const Vec3& foot, double radius, double top_radius, double height,
                int sides, Material material) {
  const Vec3 top = foot + Vec3(0, 0, height);
  const auto corner = [&](int i, double r) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0);
  };
  for (int i = 0; i < sides; ++i) {
    const Vec3 a = foot + corner(i, radius), b = foot + corner(i + 1, radius);
    const Vec3 c = top + corner(i + 1, top_radius), d = top + corner(i, top_radius);
    mesh.quad(a, b, c, d, material);
    mesh.triangle(d, c, top, material);
  }
}

void add_bar(Mesh& mesh, const Vec3& from, const Vec3& to, double width, Material material) {
  const Vec3 along = (to - from).normalized();
  const Vec3 other = std::abs(along.z()) > 0.9 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
  const Vec3 aside = other.cross(along).normalized() * (0.5 * width);
  const Vec3 up = along.cross(aside);
  const std::array<Vec3, 4> corners{aside + up, up - aside, -aside - up, aside - up};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3& a = corners[i];
    const Vec3& b = corners[(i + 1) % 4];
    mesh.quad(from + a, from + b, to + b, to + a, material);
  }
}

}  // namespace groundloop::simulation
