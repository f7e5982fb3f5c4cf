#include "frontend/simulation/sensor_noise.hpp"

#include <algorithm>
#include <cmath>

#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {

std::uint64_t NoiseModel::key_of_recording(const SimulationParameters& p) {
  return key_of(p.seed, 60, p.route, p.change);
}

double NoiseModel::faintness(const Hit& hit, double cosine) const {
  // Rough surfaces seen at a shallow angle send back less, though not as little as Lambert's law
  // has it. A surface of reflectivity 0.8 met head on is seen to the sensor's full range.
  const double reflected = properties(hit.material).reflectivity * (0.4 + 0.6 * cosine);
  return hit.range / (sensor_.max_range() * std::sqrt(reflected / 0.8));
}

double NoiseModel::loss(const Hit& hit, double faintness) const {
  const double faint = std::clamp((faintness - 0.8) / 0.3, 0.0, 1.0);
  return std::min(1.0, noise_ * (properties(hit.material).dropout + 0.005)) +
         std::min(1.0, noise_) * faint * faint;
}

Echo NoiseModel::measure(std::size_t scan, std::size_t index, const SensorRay& shot, const Ray& ray,
                         const Hit& hit, const Hit& beside, const RayCaster& caster) const {
  if (hit.range < min_range) return {};
  const auto max_range = static_cast<float>(sensor_.max_range());
  Random random(key_of(key_, scan, index));
  const double cosine = std::abs(static_cast<double>(hit.normal.dot(ray.direction)));
  const double faint = faintness(hit, cosine);
  double range = hit.range;
  Echo echo;
  const double mirrored = random.uniform(), lost = random.uniform(), edge = random.uniform();
  if (hit.material == Material::glass && mirrored < 0.04 * noise_) {
    // A pane as a mirror: the echo comes from what is seen in it, and lies behind it.
    Ray mirror = ray;
    mirror.direction = ray.direction - 2.0F * hit.normal.dot(ray.direction) * hit.normal;
    mirror.origin = ray.origin + hit.range * ray.direction + 0.01F * mirror.direction;
    const Hit seen = caster.cast(mirror, max_range - hit.range);
    if (seen.range < 0.0F) return {};
    range += seen.range;
    echo.true_echo = false;
  } else if (lost < loss(hit, faint)) {
    return {};
  }
  // The beam's footprint reaches over an edge: two echoes that are too close to be told apart are
  // one in between.
  constexpr double resolution = 1.5;
  const double gap = beside.range - hit.range;
  if (beside.range > 0.0F && std::abs(gap) > 0.15 && std::abs(gap) < resolution && cosine > 0.2 &&
      edge < noise_ * sensor_.edge_chance()) {
    range += gap * random.uniform();
    echo.true_echo = false;
  }
  const double slant = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / std::max(0.05, cosine);
  const double sigma = 0.012 + 0.0002 * range + std::min(0.10, 0.0004 * range * slant);
  range = range * sensor_.errors().range_scale +
          static_cast<double>(sensor_.errors().range[shot.beam]) +
          sensor_.errors().range_walk * std::min(1.0, faint * faint) + noise_ * random.gauss(sigma);
  if (range < min_range || range > max_range) return {};
  echo.range = static_cast<float>(range);
  return echo;
}

}  // namespace groundloop::simulation
