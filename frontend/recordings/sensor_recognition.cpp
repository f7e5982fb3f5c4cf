#include "frontend/recordings/sensor_recognition.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "frontend/recordings/packets/beam_table.hpp"

namespace groundloop::recordings {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kFewestPoints = 1000, kFewestOfRing = 10;
// Nearer, a laser's place in the housing shifts its angle.
constexpr double kNear = 1.5;
// A sensor that is tilted or calibrated differs from the manual by less than this.
constexpr double kAgreeDeg = 0.4;

struct Model {
  const char* name;
  BeamTable (*beams)();
};
constexpr std::array kModels = {
    Model{"Velodyne VLP-16", nominal_vlp16},   Model{"Velodyne Puck Hi-Res", nominal_puck_hires},
    Model{"Velodyne HDL-32E", nominal_hdl32},  Model{"Velodyne VLP-32C", nominal_vlp32c},
    Model{"Velodyne VLS-128", nominal_vls128}, Model{"Hesai PandarXT-32", nominal_xt32},
};

double elevation_deg(const Eigen::Vector3f& point) {
  const Eigen::Vector3d p = point.cast<double>();
  return std::atan2(p.z(), std::hypot(p.x(), p.y())) / kDegree;
}

double quantile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

// Median elevation of each ring, from the lowest upwards.
std::vector<double> ring_elevations(const std::vector<Scan>& scans) {
  std::map<std::uint16_t, std::vector<double>> rings;
  for (const Scan& scan : scans) {
    if (scan.attributes.ring.size() != scan.points.size()) return {};
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (static_cast<double>(scan.points[i].norm()) > kNear)
        rings[scan.attributes.ring[i]].push_back(elevation_deg(scan.points[i]));
    }
  }
  std::vector<double> elevations;
  for (auto& [ring, values] : rings) {
    if (values.size() >= kFewestOfRing) elevations.push_back(quantile(values, 0.5));
  }
  std::sort(elevations.begin(), elevations.end());
  return elevations;
}

std::string text(const char* format, double a, double b) {
  std::array<char, 96> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, a, b);
  return buffer.data();
}

// The model whose beams agree best, and by how much; empty where none does.
std::string model_of(const std::vector<double>& elevations) {
  std::string best;
  double least = kAgreeDeg;
  for (const Model& model : kModels) {
    BeamTable beams = model.beams();
    if (beams.size() != elevations.size()) continue;
    std::sort(beams.begin(), beams.end(),
              [](const Beam& a, const Beam& b) { return a.elevation < b.elevation; });
    double sum = 0.0;
    for (std::size_t i = 0; i < beams.size(); ++i)
      sum += std::abs(beams[i].elevation / kDegree - elevations[i]);
    const double mean = sum / static_cast<double>(beams.size());
    if (mean >= least) continue;
    least = mean;
    best = std::string(": as of a ") + model.name;
  }
  return best.empty() ? best : best + text(" (its beams agree to %.2g degrees)", least, 0.0);
}

// Degrees of the turn in which there are points.
double azimuths_seen(const std::vector<Scan>& scans) {
  std::array<bool, 360> seen{};
  for (const Scan& scan : scans) {
    for (const Eigen::Vector3f& p : scan.points) {
      const double turn =
          std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x())) / kDegree;
      seen[static_cast<std::size_t>(turn + 360.0) % 360U] = true;
    }
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true));
}

}  // namespace

std::string recognise_sensor(const std::vector<Scan>& scans) {
  std::vector<double> all;
  for (const Scan& scan : scans) {
    for (const Eigen::Vector3f& p : scan.points) {
      if (static_cast<double>(p.norm()) > kNear) all.push_back(elevation_deg(p));
    }
  }
  if (all.size() < kFewestPoints) return {};
  const double low = quantile(all, 0.002), high = quantile(all, 0.998);
  const double turn = azimuths_seen(scans);
  const std::string around =
      turn >= 350.0 ? "the whole turn" : text("%.0f degrees of the turn", turn, 0.0);
  const std::vector<double> rings = ring_elevations(scans);
  if (rings.size() < 4) return text("elevations from %.1f to %+.1f degrees, ", low, high) + around;
  return std::to_string(rings.size()) +
         text(" rings from %.1f to %+.1f degrees, ", rings.front(), rings.back()) + around +
         model_of(rings);
}

}  // namespace groundloop::recordings
