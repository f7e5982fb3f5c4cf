// What a LiDAR makes of true distances: range noise that grows with range and incidence, constant
// errors of beams and scale, echoes lost, mixed pixels at edges, and ghosts behind window panes.
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/simulation/ray_caster.hpp"
#include "frontend/simulation/sensor.hpp"

namespace groundloop::simulation {

struct Echo {
  float range = -1.0F;  ///< as measured; negative: none
  bool true_echo = true;
};

class NoiseModel {
 public:
  static constexpr float min_range = 1.0F;  ///< nearer echoes are the carrier's own

  NoiseModel(const Sensor& sensor, const SimulationParameters& parameters)
      : sensor_(sensor), noise_(parameters.noise), key_(key_of_recording(parameters)) {}

  /// The echo of ray `index` of scan `scan`; `beside` is the hit of the ray next to it.
  [[nodiscard]] Echo measure(std::size_t scan, std::size_t index, const SensorRay& shot,
                             const Ray& ray, const Hit& hit, const Hit& beside,
                             const RayCaster& caster) const;

 private:
  [[nodiscard]] static std::uint64_t key_of_recording(const SimulationParameters& parameters);
  /// The distance over the one at which the surface is just seen.
  [[nodiscard]] double faintness(const Hit& hit, double cosine) const;
  /// The chance that no echo comes back.
  [[nodiscard]] double loss(const Hit& hit, double faintness) const;

  const Sensor& sensor_;
  double noise_;
  std::uint64_t key_;
};

}  // namespace groundloop::simulation
