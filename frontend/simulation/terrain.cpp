#include "frontend/simulation/terrain.hpp"

#include <cmath>

#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {
namespace {

double lattice(std::uint64_t key, double x, double y) {
  const auto i = static_cast<std::int64_t>(x), j = static_cast<std::int64_t>(y);
  return 2.0 * unit(key_of(key, i, j)) - 1.0;
}

double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }

}  // namespace

double value_noise(std::uint64_t key, const Vec2& p, double wavelength) {
  const double x = p.x() / wavelength, y = p.y() / wavelength;
  const double i = std::floor(x), j = std::floor(y);
  const double u = fade(x - i), v = fade(y - j);
  const double low = lattice(key, i, j) * (1 - u) + lattice(key, i + 1, j) * u;
  const double high = lattice(key, i, j + 1) * (1 - u) + lattice(key, i + 1, j + 1) * u;
  return low * (1 - v) + high * v;
}

void add_terrain(Mesh& mesh, const Vec2& centre, double size, double step,
                 const std::function<double(const Vec2&)>& height,
                 const std::function<Material(const Vec2&)>& material) {
  const int n = static_cast<int>(std::lround(size / step));
  const Vec2 corner = centre - Vec2::Constant(0.5 * size);
  std::vector<std::uint32_t> row, previous;
  for (int j = 0; j <= n; ++j) {
    row.clear();
    for (int i = 0; i <= n; ++i) {
      const Vec2 p = corner + Vec2(i, j) * (size / n);
      row.push_back(mesh.vertex(Vec3(p.x(), p.y(), height(p))));
    }
    for (int i = 0; j > 0 && i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      mesh.triangles.push_back({previous[k], previous[k + 1], row[k + 1]});
      mesh.triangles.push_back({previous[k], row[k + 1], row[k]});
      mesh.materials.insert(mesh.materials.end(), 2,
                            material(corner + Vec2(i + 0.5, j - 0.5) * (size / n)));
    }
    previous = row;
  }
}

}  // namespace groundloop::simulation
