// Triangles with a reflectivity, and the few solids from which the simulated worlds are put
// together. Surfaces are seen from both sides; what lies inside a solid is not cleaned away.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace groundloop::simulation {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

/// What a surface is made of: how much light it sends back, and how.
enum class Material : std::uint8_t {
  asphalt,
  paving,
  grass,
  plaster,
  brick,
  concrete,
  glass,
  roof,
  wood,
  leaves,
  metal,
  paint,
  sign,
  cloth,
  water,
  count
};

struct MaterialProperties {
  double reflectivity;  ///< share of the light sent back diffusely, 0 to 1
  double dropout;       ///< chance that no echo comes back although it is near enough
};
[[nodiscard]] const MaterialProperties& properties(Material material);

/// A triangle soup about an origin of its own, so that single precision is enough anywhere.
struct Mesh {
  Vec3 origin = Vec3::Zero();
  std::vector<Eigen::Vector3f> vertices;  ///< relative to origin, metres
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Material> materials;  ///< one a triangle

  std::uint32_t vertex(const Vec3& p);
  void triangle(const Vec3& a, const Vec3& b, const Vec3& c, Material material);
  /// The corners in order around the quadrilateral.
  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Material material);
};

/// A horizontal frame for building: position on the ground and the direction of its x axis.
struct Place {
  Vec3 position = Vec3::Zero();
  Vec2 forward = Vec2::UnitX();

  [[nodiscard]] Vec3 at(double x, double y, double z) const {
    return position + Vec3(forward.x() * x - forward.y() * y, forward.y() * x + forward.x() * y, z);
  }
  [[nodiscard]] Vec2 ground(double x, double y) const { return at(x, y, 0).head<2>(); }
};

/// A box between two corners in the frame of `place`, without its underside.
void add_box(Mesh& mesh, const Place& place, const Vec3& low, const Vec3& high, Material material);
/// An upright prism of `sides` sides, or a cone stump where the radii differ, with a lid.
void add_column(Mesh& mesh, const Vec3& foot, double radius, double top_radius, double height,
                int sides, Material material);
/// A thin bar of square section between two points.
void add_bar(Mesh& mesh, const Vec3& from, const Vec3& to, double width, Material material);

}  // namespace groundloop::simulation
