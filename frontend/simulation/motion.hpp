// How the carrier moves along its way: speed with turns and stops, the ground's slope, springs,
// gait and balance. A closed function of time, so that any ray can ask for the pose of its own
// instant.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/simulation/world.hpp"

namespace groundloop::simulation {

/// A smooth line with the arc length as its parameter.
class Line {
 public:
  static constexpr double step = 0.5;  ///< between knots, m

  /// Smooths and resamples; the line is cut off at `length` metres if that is positive.
  explicit Line(const std::vector<Vec2>& points, double length = 0.0);
  [[nodiscard]] double length() const { return step * static_cast<double>(knots_.size() - 1); }
  [[nodiscard]] Vec2 point(double s) const;
  [[nodiscard]] double heading(double s) const;
  [[nodiscard]] double curvature(double s) const;

 private:
  std::vector<Vec2> knots_;
  std::vector<double> headings_;  ///< unwrapped
};

class Motion {
 public:
  Motion(const World& world, const Way& way, const SimulationParameters& parameters);
  /// Seconds from start to end of the way.
  [[nodiscard]] double duration() const { return time_.back(); }
  [[nodiscard]] const Line& line() const { return line_; }
  /// Metres along the way at a time, which is clamped to the recording.
  [[nodiscard]] double distance(double seconds) const;
  /// T_world_scan.
  [[nodiscard]] Pose pose(double seconds) const;

 private:
  struct State {
    double s, v, a;
  };
  [[nodiscard]] State state(double seconds) const;
  void plan_speed(const Way& way, const SimulationParameters& parameters);

  const World& world_;
  Line line_;
  std::string carrier_;
  std::uint64_t key_;
  std::vector<double> arc_, speed_, time_;  ///< knots of the speed profile
};

}  // namespace groundloop::simulation
