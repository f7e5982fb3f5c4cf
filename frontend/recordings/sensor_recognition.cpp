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
constexpr std::size_t kFewestPoints = 1000, kFewestOfRing = 10, kFewestRings = 4;
// Nearer, a laser's place in the housing shifts its angle.
constexpr double kNear = 1.5;
// A sensor that is calibrated differs from the manual by less than this.
constexpr double kAgreeDeg = 0.4;
// A model of which fewer beams are seen is not told by them.
constexpr double kSeenShare = 0.6;
constexpr std::size_t kMostNamed = 3;

struct Model {
  const char* name;
  BeamTable (*beams)();
};
constexpr std::array kModels = {
    Model{"Velodyne VLP-16", nominal_vlp16},   Model{"Velodyne Puck Hi-Res", nominal_puck_hires},
    Model{"Velodyne HDL-32E", nominal_hdl32},  Model{"Velodyne VLP-32C", nominal_vlp32c},
    Model{"Velodyne VLS-128", nominal_vls128}, Model{"Hesai PandarXT-32", nominal_xt32},
};

// Fields of view of data sheets, for sensors whose beams differ from one to the next, or whose
// scans tell no ring. beams: 0 where the sensor has no rows.
struct View {
  const char* name;
  std::size_t beams;
  double low, high, turn;  ///< degrees
};
constexpr std::array kViews = {
    View{"Velodyne HDL-64E", 64, -24.8, 2.0, 360},
    View{"Velodyne HDL-32E", 32, -30.7, 10.7, 360},
    View{"Velodyne VLP-16", 16, -15, 15, 360},
    View{"Velodyne VLP-32C", 32, -25, 15, 360},
    View{"Velodyne VLS-128", 128, -25, 15, 360},
    View{"Ouster OS0-32", 32, -45, 45, 360},
    View{"Ouster OS0-64", 64, -45, 45, 360},
    View{"Ouster OS0-128", 128, -45, 45, 360},
    View{"Ouster OS1-16 (first generation)", 16, -16.6, 16.6, 360},
    View{"Ouster OS1-64 (first generation)", 64, -16.6, 16.6, 360},
    View{"Ouster OS1-32", 32, -21.2, 21.2, 360},
    View{"Ouster OS1-64", 64, -21.2, 21.2, 360},
    View{"Ouster OS1-128", 128, -21.2, 21.2, 360},
    View{"Ouster OS2-32", 32, -11.2, 11.2, 360},
    View{"Ouster OS2-64", 64, -11.2, 11.2, 360},
    View{"Ouster OS2-128", 128, -11.2, 11.2, 360},
    View{"Hesai Pandar40P", 40, -25, 15, 360},
    View{"Hesai Pandar64", 64, -25, 15, 360},
    View{"Hesai Pandar128", 128, -25, 15, 360},
    View{"Hesai PandarQT64", 64, -52.1, 52.1, 360},
    View{"Hesai PandarXT-32", 32, -16, 15, 360},
    View{"Robosense RS-LiDAR-16", 16, -15, 15, 360},
    View{"Robosense RS-LiDAR-32", 32, -25, 15, 360},
    View{"Robosense Helios-32", 32, -55, 15, 360},
    View{"Robosense Bpearl", 32, 2.3, 89.5, 360},
    View{"Robosense E1", 0, -45, 45, 120},
    View{"Robosense M1", 0, -12.5, 12.5, 120},
    View{"Livox Avia", 0, -38.6, 38.6, 70.4},
    View{"Livox Mid-70", 0, -35.2, 35.2, 70.4},
    View{"Livox Mid-40", 0, -19.2, 19.2, 38.4},
    View{"Livox Horizon", 0, -12.55, 12.55, 81.7},
    View{"Livox Tele-15", 0, -8.1, 8.1, 14.5},
    View{"Livox HAP", 0, -12.5, 12.5, 120},
    View{"Livox Mid-360", 0, -7, 52, 360},
    View{"Aeva Aeries II", 0, -15, 15, 120},
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

std::string text(const char* format, double a, double b = 0.0) {
  std::array<char, 96> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, a, b);
  return buffer.data();
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

// Mean distance of the elevations from the beams, each to another beam, both from the lowest up;
// infinite where one has none within reach.
double misfit(const std::vector<double>& elevations, const BeamTable& beams) {
  std::size_t next = 0;
  double sum = 0.0;
  for (const double elevation : elevations) {
    const auto distance = [&](std::size_t k) {
      return std::abs(beams[k].elevation / kDegree - elevation);
    };
    while (next + 1 < beams.size() && distance(next + 1) < distance(next)) ++next;
    if (next >= beams.size() || distance(next) > kAgreeDeg) return INFINITY;
    sum += distance(next++);
  }
  return sum / static_cast<double>(elevations.size());
}

// By the beams one by one: the model with the fewest beams that has all of those seen.
bool recognise_beams(const std::vector<double>& elevations, SensorEvidence& found) {
  double least = kAgreeDeg;
  std::size_t fewest = 0;
  for (const Model& model : kModels) {
    BeamTable beams = model.beams();
    if (beams.size() < elevations.size()) continue;
    const double share = static_cast<double>(elevations.size()) / static_cast<double>(beams.size());
    if (share < kSeenShare || (fewest > 0 && beams.size() > fewest)) continue;
    std::sort(beams.begin(), beams.end(),
              [](const Beam& a, const Beam& b) { return a.elevation < b.elevation; });
    const double mean = misfit(elevations, beams);
    if (!(mean < kAgreeDeg) || (beams.size() == fewest && mean >= least)) continue;
    least = mean;
    fewest = beams.size();
    found.models = {model.name};
    const bool all = beams.size() == elevations.size();
    found.evidence = (all ? "its " : std::to_string(elevations.size()) + " of its ") +
                     std::to_string(beams.size()) + " beams " + (all ? "" : "are seen, and ") +
                     text("agree to %.2g degrees", least);
  }
  return !found.models.empty();
}

// By the field of view.
void recognise_view(SensorEvidence& found) {
  const bool rings = found.rings >= kFewestRings;
  // Nothing is seen beyond the view, but for near points and a tilt; its edges may see nothing.
  const double beyond = rings ? 0.7 : 2.0, short_of = rings ? 2.0 : 4.0;
  std::vector<std::pair<double, const char*>> agreeing;
  for (const View& view : kViews) {
    const double low = found.lowest_deg - view.low, high = view.high - found.highest_deg;
    // Oblique rays reach beyond a view that is no whole turn.
    const double turn = std::abs(view.turn - found.turn_deg);
    const bool whole = view.turn == 360.0;
    if (std::max(low, high) > short_of || std::min(low, high) < -beyond) continue;
    if (turn > (whole ? 80.0 : 0.25 * view.turn)) continue;
    if (rings && view.beams != found.rings) continue;
    const auto misfit_of = [](double end) { return end < 0.0 ? -2.0 * end : end; };
    agreeing.emplace_back(misfit_of(low) + misfit_of(high) + (whole ? 0.0 : 0.1 * turn), view.name);
  }
  std::sort(agreeing.begin(), agreeing.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [distance, name] : agreeing) {
    if (found.models.size() < kMostNamed) found.models.emplace_back(name);
  }
  if (!agreeing.empty()) {
    found.evidence =
        rings ? "by the number of its beams and its field of view" : "by the field of view";
  }
}

// Degrees of the turn in which there are points: not those that a few stray ones reach.
double azimuths_seen(const std::vector<Scan>& scans) {
  std::array<std::size_t, 360> count{};
  std::size_t points = 0;
  for (const Scan& scan : scans) {
    for (const Eigen::Vector3f& p : scan.points) {
      const double turn =
          std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x())) / kDegree;
      ++count[static_cast<std::size_t>(turn + 360.0) % 360U];
      ++points;
    }
  }
  const auto few = static_cast<std::size_t>(0.03 * static_cast<double>(points) / 360.0);
  return static_cast<double>(
      std::count_if(count.begin(), count.end(), [&](std::size_t n) { return n > few; }));
}

}  // namespace

std::string SensorEvidence::described() const {
  if (lowest_deg == 0.0 && highest_deg == 0.0) return {};
  std::string sentence = rings >= kFewestRings ? std::to_string(rings) + " rings" : "elevations";
  sentence += text(" from %.1f to %+.1f degrees, ", lowest_deg, highest_deg);
  sentence += turn_deg >= 350.0 ? "the whole turn" : text("%.0f degrees of the turn", turn_deg);
  const bool vowel = !models.empty() && (models[0][0] == 'O' || models[0][0] == 'A');
  for (std::size_t i = 0; i < models.size(); ++i) {
    const char* before = i > 0   ? (i + 1 == models.size() ? " or " : ", ")
                         : vowel ? ": as of an "
                                 : ": as of a ";
    sentence += before + models[i];
  }
  return models.empty() ? sentence : sentence + " (" + evidence + ")";
}

SensorEvidence recognise_sensor(const std::vector<Scan>& scans) {
  SensorEvidence found;
  std::vector<double> all;
  for (const Scan& scan : scans) {
    for (const Eigen::Vector3f& p : scan.points) {
      if (static_cast<double>(p.norm()) > kNear) all.push_back(elevation_deg(p));
    }
  }
  if (all.size() < kFewestPoints) return found;
  const std::vector<double> rings = ring_elevations(scans);
  found.rings = rings.size() >= kFewestRings ? rings.size() : 0;
  found.lowest_deg = found.rings > 0 ? rings.front() : quantile(all, 0.0005);
  found.highest_deg = found.rings > 0 ? rings.back() : quantile(all, 0.9995);
  found.turn_deg = azimuths_seen(scans);
  if (found.rings == 0 || !recognise_beams(rings, found)) recognise_view(found);
  return found;
}

}  // namespace groundloop::recordings
