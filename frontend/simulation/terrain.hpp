// Smooth heights from value noise, and the mesh that the rays meet. Streets follow the terrain; it
// has no overhangs and no steps.
#pragma once

#include <cstdint>
#include <functional>

#include "frontend/simulation/mesh.hpp"

namespace groundloop::simulation {

/// Noise in [-1, 1] with continuous second derivatives, of the given wavelength (m).
[[nodiscard]] double value_noise(std::uint64_t key, const Vec2& p, double wavelength);

/// The ground as a grid over a square about `centre`; `material` is asked at each cell's middle.
void add_terrain(Mesh& mesh, const Vec2& centre, double size, double step,
                 const std::function<double(const Vec2&)>& height,
                 const std::function<Material(const Vec2&)>& material);

}  // namespace groundloop::simulation
