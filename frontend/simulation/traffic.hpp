// Cars and people that move about the carrier's way: cars ahead of it for a long time, cars that
// come the other way, and people on the pavement. Functions of time.
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/simulation/motion.hpp"
#include "frontend/simulation/ray_caster.hpp"

namespace groundloop::simulation {

class Traffic {
 public:
  Traffic(const World& world, const Motion& motion, const Way& way,
          const SimulationParameters& parameters, RayCaster& caster);
  /// Bodies within `reach` metres of the carrier between two times.
  [[nodiscard]] std::vector<MovingBody> bodies(double from, double to, double reach) const;

 private:
  struct Agent {
    std::size_t shape;
    double s0, t0;       ///< where along the way at what time
    double speed;        ///< along the way, negative: against it, m/s
    double lateral;      ///< offset to the left of the way, m; what `side` adds comes on top
    int side;            ///< 0: own lane, 1: opposite lane, 2 left pavement, 3 right pavement
    double from, until;  ///< seconds in which it is there
    bool follows;        ///< keeps its distance `s0` ahead of the carrier instead
  };
  [[nodiscard]] Pose pose(const Agent& agent, double seconds) const;
  [[nodiscard]] double along(const Agent& agent, double seconds) const;

  const World& world_;
  const Motion& motion_;
  std::vector<double> oncoming_, pavement_, centre_;  ///< by knots of the line
  std::vector<Agent> agents_;                         ///< by `from`
};

}  // namespace groundloop::simulation
