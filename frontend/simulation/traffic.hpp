// Cars and people that move about the carrier's way: cars ahead of it for a long time, cars that
// overtake it or come the other way, and people on the pavement. Functions of time. They come from
// beyond the sensor's range and leave beyond it, and keep clear of the carrier.
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/simulation/motion.hpp"
#include "frontend/simulation/random.hpp"
#include "frontend/simulation/ray_caster.hpp"

namespace groundloop::simulation {

class Traffic {
 public:
  Traffic(const World& world, const Motion& motion, const Way& way,
          const SimulationParameters& parameters, RayCaster& caster);
  /// Bodies within `reach` metres of the carrier between two times.
  [[nodiscard]] std::vector<MovingBody> bodies(double from, double to, double reach) const;

 private:
  enum class Lane { carrier, along, oncoming, left_pavement, right_pavement };
  struct Agent {
    std::size_t shape;
    Lane lane;
    double s0, t0;       ///< where along the way at what time
    double speed;        ///< along the way, negative: against it, m/s
    double lateral;      ///< offset to the left of its lane, m
    double from, until;  ///< seconds in which it is there
    /// Not zero: it drives as the carrier does, so many seconds ahead (behind, where negative).
    double lead = 0.0;
  };
  /// `gap` stretches the time (or way) from one to the next.
  void add_followers(double end, double gap, Random& random);
  void add_cars(double end, bool overtake, double gap, Random& random);
  void add_people(double gap, Random& random);
  /// Adds an agent unless it would run into the carrier.
  void add(const Agent& agent);
  [[nodiscard]] Pose pose(const Agent& agent, double seconds) const;
  [[nodiscard]] double along(const Agent& agent, double seconds) const;
  /// When the carrier comes by; 0 before its way begins.
  [[nodiscard]] double time_at(double s) const;

  const World& world_;
  const Motion& motion_;
  std::vector<double> along_, oncoming_, pavement_, centre_;  ///< by knots of the line
  std::vector<Agent> agents_;
};

}  // namespace groundloop::simulation
