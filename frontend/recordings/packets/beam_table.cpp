#include "frontend/recordings/packets/beam_table.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/dataset_calibration.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr std::array kVlp32cElevations = {
    -25.0,  -1.0,   -1.667, -15.639, -11.31, 0.0,    -0.667, -8.843, -7.254, 0.333,  -0.333,
    -6.148, -5.333, 1.333,  0.667,   -4.0,   -4.667, 1.667,  1.0,    -3.667, -3.333, 3.333,
    2.333,  -2.667, -3.0,   7.0,     4.667,  -2.333, -2.0,   15.0,   10.333, -1.333};
constexpr std::array kVlp32cAzimuths = {
    1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4,
    1.4, -4.2, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4};
constexpr std::array kVls128Elevations = {
    -11.742, -1.99,   3.4,   -5.29,   -0.78, 4.61,  -4.08,   1.31,   -6.5,  -1.11,   4.28,  -4.41,
    0.1,     6.48,    -3.2,  2.19,    -3.86, 1.53,  -9.244,  -1.77,  2.74,  -5.95,   -0.56, 4.83,
    -2.98,   2.41,    -6.28, -0.89,   3.62,  -5.07, 0.32,    7.58,   -0.34, 5.18,    -3.64, 1.75,
    -25.0,   -2.43,   2.96,  -5.73,   0.54,  9.7,   -2.76,   2.63,   -7.65, -1.55,   3.84,  -4.85,
    3.18,    -5.51,   -0.12, 5.73,    -4.3,  1.09,  -16.042, -2.21,  4.06,  -4.63,   0.76,  15.0,
    -3.42,   1.97,    -6.85, -1.33,   -5.62, -0.23, 5.43,    -3.53,  0.98,  -19.582, -2.32, 3.07,
    -4.74,   0.65,    11.75, -2.65,   1.86,  -7.15, -1.44,   3.95,   -2.1,  3.29,    -5.4,  -0.01,
    4.5,     -4.19,   1.2,   -13.565, -1.22, 4.17,  -4.52,   0.87,   6.08,  -3.31,   2.08,  -6.65,
    1.42,    -10.346, -1.88, 3.51,    -6.06, -0.67, 4.72,    -3.97,  2.3,   -6.39,   -1.0,  4.39,
    -5.18,   0.21,    6.98,  -3.09,   4.98,  -3.75, 1.64,    -8.352, -2.54, 2.85,    -5.84, -0.45,
    8.43,    -2.87,   2.52,  -6.17,   -1.66, 3.73,  -4.96,   0.43,
};
// The eight lasers that VLS-128 fires together.
constexpr std::array kVls128Azimuths = {6.354, 4.548, 2.732, 0.911, -0.911, -2.732, -4.548, -6.354};

Beam beam(double elevation_deg, double azimuth_deg) {
  return {elevation_deg * kRadiansPerDegree, azimuth_deg * kRadiansPerDegree, 0.0, 0.0, 0.0};
}

// Two fans of evenly spaced beams that fire in turns.
BeamTable two_fans(std::size_t beams, double first, double second, double step) {
  BeamTable table;
  for (std::size_t i = 0; i < beams; ++i)
    table.push_back(beam((i % 2 == 0 ? first : second) + step * static_cast<double>(i / 2), 0.0));
  return table;
}

[[noreturn]] void wrong_count(const fs::path& file, std::size_t found, std::size_t expected) {
  throw InputError(file.string() + ": calibrates " + std::to_string(found) +
                   " lasers, the recorded sensor has " + std::to_string(expected) +
                   "; give its own file with --calibration");
}

}  // namespace

BeamTable read_velodyne_calibration(const fs::path& file, std::size_t beams) {
  const std::string text = read_text(file);
  try {
    const YAML::Node root = YAML::Load(text);
    const YAML::Node lasers = root.IsMap() ? root["lasers"] : YAML::Node();
    if (!lasers || !lasers.IsSequence()) {
      throw InputError(file.string() +
                       ": has no list 'lasers'; expected a calibration of "
                       "Velodyne's ROS driver");
    }
    if (lasers.size() != beams) wrong_count(file, lasers.size(), beams);
    BeamTable table(beams);
    std::vector<bool> seen(beams, false);
    for (const YAML::Node& laser : lasers) {
      const auto id = laser["laser_id"].as<std::size_t>();
      if (id >= beams || seen[id])
        throw InputError(file.string() + ": laser_id " + std::to_string(id) +
                         " is there twice or beyond the number of lasers");
      seen[id] = true;
      const auto value = [&](const char* key) {
        return laser[key] ? laser[key].as<double>() : 0.0;
      };
      // Velodyne subtracts the correction from the azimuth.
      table[id] = {value("vert_correction"), -value("rot_correction"), value("dist_correction"),
                   value("vert_offset_correction"), value("horiz_offset_correction")};
    }
    return table;
  } catch (const YAML::Exception& e) {
    throw InputError(file.string() + ": is no YAML calibration that can be read (" + e.what() +
                     ")");
  }
}

BeamTable read_hesai_calibration(const fs::path& file, std::size_t beams) {
  std::istringstream text(read_text(file));
  BeamTable table;
  std::string line;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::string channel, elevation, azimuth;
    double id = 0.0, e = 0.0, a = 0.0;
    if (!(fields >> channel) || !parse_double(channel, id)) continue;  // titles and empty lines
    fields >> elevation >> azimuth;
    if (!parse_double(elevation, e) || !parse_double(azimuth, a) ||
        id != static_cast<double>(table.size() + 1)) {
      throw InputError(file.string() + ":" + std::to_string(number) +
                       ": expected 'channel,elevation,azimuth' with channels from 1 upwards");
    }
    table.push_back(beam(e, a));
    if (table.size() > beams) break;
  }
  if (table.size() != beams) wrong_count(file, table.size(), beams);
  return table;
}

BeamTable nominal_vlp16() { return two_fans(16, -15.0, 1.0, 2.0); }
BeamTable nominal_puck_hires() { return two_fans(16, -10.0, 2.0 / 3.0, 4.0 / 3.0); }
BeamTable nominal_hdl32() { return two_fans(32, -92.0 / 3.0, -28.0 / 3.0, 4.0 / 3.0); }

BeamTable nominal_vlp32c() {
  BeamTable table;
  for (std::size_t i = 0; i < kVlp32cElevations.size(); ++i)
    table.push_back(beam(kVlp32cElevations[i], kVlp32cAzimuths[i]));
  return table;
}

BeamTable nominal_vls128() {
  BeamTable table;
  for (std::size_t i = 0; i < kVls128Elevations.size(); ++i)
    table.push_back(beam(kVls128Elevations[i], kVls128Azimuths[i % kVls128Azimuths.size()]));
  return table;
}

BeamTable nominal_xt32() {
  BeamTable table;
  for (int i = 0; i < 32; ++i) table.push_back(beam(15.0 - i, 0.0));
  return table;
}

std::vector<std::uint16_t> rings_of(const BeamTable& beams) {
  std::vector<std::size_t> order(beams.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return beams[a].elevation < beams[b].elevation;
  });
  std::vector<std::uint16_t> rings(beams.size());
  for (std::size_t k = 0; k < order.size(); ++k) rings[order[k]] = static_cast<std::uint16_t>(k);
  return rings;
}

}  // namespace groundloop::recordings
