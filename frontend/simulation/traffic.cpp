#include "frontend/simulation/traffic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frontend/simulation/random.hpp"
#include "frontend/simulation/scenery.hpp"

namespace groundloop::simulation {
namespace {

constexpr int car_shapes = 8, person_shapes = 6;

/// A value of the way's points at each knot of the line, by arc length.
std::vector<double> by_knot(const Way& way, const std::vector<double>& values, const Line& line) {
  std::vector<double> result;
  double arc = 0.0;
  std::size_t i = 0;
  for (double s = 0.0; s <= line.length() + 1e-9; s += Line::step) {
    while (i + 1 < way.points.size()) {
      const double d = (way.points[i + 1] - way.points[i]).norm();
      if (arc + d > s) break;
      arc += d;
      ++i;
    }
    result.push_back(values[i]);
  }
  return result;
}

}  // namespace

Traffic::Traffic(const World& world, const Motion& motion, const Way& way,
                 const SimulationParameters& parameters, RayCaster& caster)
    : world_(world),
      motion_(motion),
      oncoming_(by_knot(way, way.oncoming, motion.line())),
      pavement_(by_knot(way, way.pavement, motion.line())),
      centre_(by_knot(way, way.centre, motion.line())) {
  for (int i = 0; i < car_shapes + person_shapes; ++i) {
    Mesh mesh;
    Random shape(key_of(parameters.seed, 70, i));
    if (i < car_shapes) {
      add_car(mesh, Place{}, shape);
    } else {
      add_person(mesh, Place{}, shape);
    }
    caster.add_shape(mesh);
  }
  Random random(key_of(parameters.seed, 71, parameters.route, parameters.change));
  const auto car = [&] { return static_cast<std::size_t>(random.below(car_shapes)); };
  const auto person = [&] {
    return static_cast<std::size_t>(car_shapes + random.below(person_shapes));
  };
  const double end = motion.duration();
  const bool drives = parameters.carrier == "car" && way.cars;
  for (double t = random.uniform(0, 20); drives && t < end;) {  // ahead, and behind
    const double stays = random.uniform(15, 60);
    agents_.push_back({car(), random.uniform(1.3, 2.6), 0, 0, 0, 0, t, t + stays, true});
    if (random.chance(0.4)) {
      agents_.push_back({car(), -random.uniform(1.5, 2.5), 0, 0, 0, 0, t, t + stays, true});
    }
    t += stays + random.uniform(10, 70);
  }
  for (double t = random.uniform(0, 8); way.cars && t < end; t += random.uniform(4, 16)) {
    agents_.push_back(
        {car(), motion.distance(t), t, -random.uniform(5, 10), 0.0, 1, t - 14, t + 14, false});
  }
  for (double s = 5.0; s < motion.line().length(); s += random.uniform(6, 40)) {
    // When the carrier comes by; duration is short against the way, so halving will do.
    double low = 0.0, high = end;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (low + high);
      (motion.distance(middle) < s ? low : high) = middle;
    }
    const double speed = random.uniform(0.7, 1.7) * (random.chance(0.5) ? 1.0 : -1.0);
    agents_.push_back({person(), s, low, speed, random.uniform(-0.6, 0.6),
                       random.chance(0.5) ? 2 : 3, low - 40, low + 40, false});
  }
}

double Traffic::along(const Agent& agent, double seconds) const {
  if (!agent.follows) return agent.s0 + agent.speed * (seconds - agent.t0);
  // The same drive some seconds sooner or later, and never on the carrier's bumper.
  const double gap = agent.s0 > 0.0 ? 7.0 : -7.0;
  return motion_.distance(seconds + agent.s0) + gap;
}

Pose Traffic::pose(const Agent& agent, double seconds) const {
  const double s = along(agent, seconds);
  const Line& line = motion_.line();
  const auto k =
      std::min(static_cast<std::size_t>(std::max(0.0, s / Line::step)), oncoming_.size() - 1);
  double lateral = agent.lateral;
  if (agent.side == 1) lateral += oncoming_[k];
  if (agent.side == 2) lateral += centre_[k] + pavement_[k];
  if (agent.side == 3) lateral += centre_[k] - pavement_[k];
  const double heading = line.heading(s);
  const Vec2 p = line.point(s) + lateral * Vec2(-std::sin(heading), std::cos(heading));
  const bool reversed = !agent.follows && agent.speed < 0.0;
  const Eigen::AngleAxisd turn(heading + (reversed ? std::numbers::pi : 0.0), Vec3::UnitZ());
  return Pose(Eigen::Quaterniond(turn),
              Vec3(p.x(), p.y(), world_.ground(p) + (agent.side >= 2 ? 0.12 : 0.0)));
}

std::vector<MovingBody> Traffic::bodies(double from, double to, double reach) const {
  std::vector<MovingBody> result;
  const double here = motion_.distance(from);
  for (const Agent& agent : agents_) {
    if (from < agent.from || to > agent.until) continue;
    const double s = along(agent, from);
    if (std::abs(s - here) > 2.0 * reach || s < 1.0 || s > motion_.line().length() - 1.0) continue;
    result.push_back({agent.shape, pose(agent, from), pose(agent, to)});
  }
  return result;
}

}  // namespace groundloop::simulation
