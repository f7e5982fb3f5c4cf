// The scan patterns of the simulated LiDARs, and the constant errors that each built sensor has.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "frontend/simulation/mesh.hpp"
#include "frontend/simulation/simulation.hpp"

namespace groundloop::simulation {

struct SensorRay {
  Eigen::Vector3f direction;  ///< where the light goes, in the scan frame
  Eigen::Vector3f reported;   ///< where the sensor believes that it goes
  std::uint16_t slot;         ///< which of the scan's instants it is fired at
  std::uint16_t beam;
};

/// Errors scale with the parameters' noise.
struct BeamErrors {
  std::vector<float> range;  ///< constant error of each beam, m
  double range_scale = 1.0;
  double range_walk = 0.0;  ///< how much too far the faintest echoes are measured, m
};

class Sensor {
 public:
  static constexpr double period = 0.1;  ///< of a scan, s

  explicit Sensor(const SimulationParameters& parameters);
  /// Rays of a scan in firing order; the same number in every scan.
  void fire(std::size_t scan, std::vector<SensorRay>& rays) const;
  [[nodiscard]] int slots() const { return slots_; }
  /// Distance in ray index to the ray that lies beside one in the sweep.
  [[nodiscard]] std::size_t neighbour() const { return neighbour_; }
  [[nodiscard]] double slot_time(int slot) const { return period * slot / slots_; }
  [[nodiscard]] const BeamErrors& errors() const { return errors_; }
  [[nodiscard]] double max_range() const { return max_range_; }
  /// Divergence of a beam over the angle between neighbours: the chance to graze an edge.
  [[nodiscard]] double edge_chance() const { return edge_chance_; }
  [[nodiscard]] const std::string& description() const { return description_; }

 private:
  void make_spinning(const SimulationParameters& parameters);
  void make_raster();
  void fire_rosette(std::size_t scan, std::vector<SensorRay>& rays) const;
  void draw_errors(const SimulationParameters& parameters, std::size_t beams);
  /// Direction of azimuth and elevation, and the same with the beam's elevation error.
  [[nodiscard]] SensorRay ray(double azimuth, double elevation, int slot, std::size_t beam) const;

  /// An error that goes once around with the azimuth: an encoder out of centre, an axis askew.
  struct Wobble {
    double size = 0.0, phase = 0.0;  ///< radians
    [[nodiscard]] double at(double azimuth) const { return size * std::sin(azimuth + phase); }
  };

  std::vector<SensorRay> rays_;  ///< empty for the rosette, whose every scan differs
  std::vector<double> elevation_errors_;
  Wobble encoder_, axis_;
  BeamErrors errors_;
  int slots_ = 1024;
  std::size_t neighbour_ = 1;
  double max_range_ = 120.0, edge_chance_ = 0.3;
  std::string description_;
};

}  // namespace groundloop::simulation
