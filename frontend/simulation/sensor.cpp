#include "frontend/simulation/sensor.hpp"

#include <cmath>
#include <numbers>

#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// Beams from top to bottom, degrees.
std::vector<double> elevations(const std::string& sensor) {
  std::vector<double> result;
  const auto spread = [&](int n, double top, double bottom) {
    for (int i = 0; i < n; ++i) result.push_back(top + (bottom - top) * i / (n - 1));
  };
  if (sensor == "spin16") spread(16, 15.0, -15.0);
  if (sensor == "spin32") spread(32, 10.67, -30.67);
  if (sensor == "spin64") {  // an upper and a lower block of different pitch
    spread(32, 2.0, -8.33);
    spread(32, -8.83, -24.33);
  }
  if (sensor == "spin128") spread(128, 15.0, -25.0);
  return result;
}

}  // namespace

Sensor::Sensor(const SimulationParameters& parameters) {
  if (parameters.sensor == "raster") {
    draw_errors(parameters, 80);
    make_raster();
  } else if (parameters.sensor == "rosette") {
    draw_errors(parameters, 6);
    slots_ = 1000;
    edge_chance_ = 0.4;
    description_ = "rosette, 70 x 77 degrees, non-repeating, 24000 points a scan";
  } else {
    make_spinning(parameters);
  }
}

void Sensor::draw_errors(const SimulationParameters& parameters, std::size_t beams) {
  // One built sensor: its errors stay with it on every drive of this seed.
  std::uint64_t name = 0;
  for (const char c : parameters.sensor) name = key_of(name, static_cast<unsigned char>(c));
  Random random(key_of(parameters.seed, 50, name));
  const double noise = parameters.noise;
  const auto of_either_sign = [&](double low, double high) {
    const double size = random.uniform(low, high);
    return noise * (random.chance(0.5) ? size : -size);
  };
  const double tilt = of_either_sign(0.18 * degree, 0.32 * degree);
  errors_.range_scale = 1.0 + of_either_sign(0.0012, 0.0032);
  errors_.range_walk = noise * random.uniform(0.04, 0.10);
  for (Wobble* w : {&encoder_, &axis_}) {
    *w = {of_either_sign(0.12 * degree, 0.25 * degree),
          random.uniform(0.0, 2.0 * std::numbers::pi)};
  }
  for (std::size_t i = 0; i < beams; ++i) {
    elevation_errors_.push_back(tilt + noise * random.gauss(0.06 * degree));
    errors_.range.push_back(static_cast<float>(parameters.noise * random.gauss(0.02)));
  }
}

SensorRay Sensor::ray(double azimuth, double elevation, int slot, std::size_t beam) const {
  const auto direction = [](double a, double e) {
    return Vec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e))
        .cast<float>()
        .eval();
  };
  const double true_azimuth = azimuth + encoder_.at(azimuth);
  const double true_elevation = elevation + elevation_errors_[beam] + axis_.at(azimuth);
  return {direction(true_azimuth, true_elevation), direction(azimuth, elevation),
          static_cast<std::uint16_t>(slot), static_cast<std::uint16_t>(beam)};
}

void Sensor::make_spinning(const SimulationParameters& parameters) {
  const std::vector<double> beams = elevations(parameters.sensor);
  draw_errors(parameters, beams.size());
  slots_ = 1024;
  neighbour_ = beams.size();
  const double half_view = 0.5 * parameters.fov * degree;
  for (int column = 0; column < slots_; ++column) {
    // Once around from the rear, anticlockwise; the blind sector lies there.
    const double azimuth = (2.0 * (column + 0.5) / slots_ - 1.0) * std::numbers::pi;
    if (std::abs(azimuth) > half_view) continue;
    for (std::size_t b = 0; b < beams.size(); ++b) {
      rays_.push_back(ray(azimuth, beams[b] * degree, column, b));
    }
  }
  description_ = std::to_string(beams.size()) + " beams x 1024, " +
                 std::to_string(static_cast<int>(parameters.fov)) + " degrees around";
}

void Sensor::make_raster() {
  constexpr int lines = 80, columns = 600;
  slots_ = 1000;
  for (int line = 0; line < lines; ++line) {
    for (int c = 0; c < columns; ++c) {
      // To and fro, from top to bottom once a scan.
      const double u = (c + 0.5) / columns, v = (line + 0.5) / lines;
      const double azimuth = 120.0 * degree * ((line % 2 == 0 ? u : 1.0 - u) - 0.5);
      const double elevation = 19.0 * degree * (0.5 - v) - 2.5 * degree;
      const int slot = (line * columns + c) * slots_ / (lines * columns);
      rays_.push_back(ray(azimuth, elevation, slot, static_cast<std::size_t>(line)));
    }
  }
  description_ = "raster, 120 x 19 degrees, 80 x 600";
}

void Sensor::fire_rosette(std::size_t scan, std::vector<SensorRay>& rays) const {
  constexpr int shots = 4000;
  constexpr std::size_t beams = 6;
  for (int i = 0; i < shots; ++i) {
    const double t = period * (static_cast<double>(scan) + static_cast<double>(i) / shots);
    // Two prisms that turn at rates without a common measure draw a rose that never closes.
    const double a = 2 * std::numbers::pi * std::fmod(119.7071 * t, 1.0);
    const double b = 2 * std::numbers::pi * std::fmod(-80.31803 * t, 1.0);
    const double x = 0.5 * (std::cos(a) + std::cos(b)), y = 0.5 * (std::sin(a) + std::sin(b));
    for (std::size_t k = 0; k < beams; ++k) {
      const double shift = (static_cast<double>(k) - 2.5) * 0.35 * degree;
      rays.push_back(ray(35.0 * degree * x, (38.5 * degree - 0.9 * degree) * y + shift,
                         i * slots_ / shots, k));
    }
  }
}

void Sensor::fire(std::size_t scan, std::vector<SensorRay>& rays) const {
  rays.clear();
  if (rays_.empty()) {
    fire_rosette(scan, rays);
  } else {
    rays = rays_;
  }
}

}  // namespace groundloop::simulation
