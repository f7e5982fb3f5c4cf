// The simulated recording: a made-up place that is scanned by a made-up LiDAR on a carrier that
// drives, walks or rolls through it, with exact ground truth. Every ray is cast from the pose of
// its own time; the same specification gives the same bytes. See README.md beside this file for
// what is modelled and what is not.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "frontend/recordings/recording.hpp"

namespace groundloop {

/// What `sim:WORLD?key=value&...` says.
struct SimulationParameters {
  std::string world = "town";     ///< town, bridge, park
  std::string sensor = "spin64";  ///< spin16, spin32, spin64, spin128, raster, rosette
  std::string carrier = "car";    ///< car, walker, segway
  double length = 1000.0;         ///< of the way, m
  std::uint64_t seed = 1;         ///< of the world and of the sensor's calibration errors
  std::uint64_t route = 1;        ///< of the way through the world and the noise of single rays
  int change = 0;                 ///< 0, 1, ...: the same place on another day
  double noise = 1.0;             ///< factor on all sensor errors
  double traffic = 1.0;           ///< factor on how many cars and people move; 0 is none
  double fov = 360.0;             ///< of a spinning sensor, degrees: 360, or 290 (blind behind)
  /// any, west or east: a way in the west and one in the east (of the same seed, in town or park)
  /// have one street in common, with which both begin, and no other.
  std::string side = "any";
  /// there, or back: the same streets from their end to their beginning, in the other lane (in town
  /// or park).
  std::string way = "there";
};

/// Parses a specification. Throws InputError naming the key, the value and what is allowed.
[[nodiscard]] SimulationParameters parse_simulation(const std::string& specification);
/// True where a recording's path is meant for open_simulation.
[[nodiscard]] bool is_simulation(const std::string& path);

enum class ScanInstant { start, middle, end };

/// What the simulation knows of a point beside its coordinates.
struct PointTruth {
  std::uint64_t surface = 0;  ///< the same for points of one flat face, else different
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< of that face, in the simulation's world
  float range = 0.0F;                                ///< true distance from the sensor, m
  bool moving = false;                               ///< on a car or person that moves
  bool true_echo = true;                             ///< false for mixed pixels and ghosts
};

class SimulatedRecording : public Recording {
 public:
  [[nodiscard]] virtual const SimulationParameters& parameters() const = 0;
  /// T_world_scan at any time of the recording; the world (x east, y north, z up, metres) is the
  /// same for all recordings with the same world and seed.
  [[nodiscard]] virtual Pose pose_at(Nanoseconds time) const = 0;
  /// T_world_scan at an instant of each scan, stamped with that instant. ground_truth() is that of
  /// the start, which is what the scans' stamps name.
  [[nodiscard]] virtual Trajectory ground_truth_at(ScanInstant instant) const = 0;
  /// Scan `index` with one PointTruth a point.
  [[nodiscard]] virtual Scan read_with_truth(std::size_t index, std::vector<PointTruth>& truth) = 0;
};

/// Opens `sim:WORLD?key=value&...`. Throws InputError as parse_simulation does.
[[nodiscard]] std::unique_ptr<SimulatedRecording> open_simulation(const std::string& specification);

}  // namespace groundloop
